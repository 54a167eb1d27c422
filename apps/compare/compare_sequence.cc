#include "apps/compare/compare_sequence.h"

#include "core/geometry/motion.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

// Figures of a run; unknown ones are empty.
using LossFigures = std::vector<std::optional<double>>;

// The last pose of a run relative to its first, in the thesis' parameters:
// alpha, beta, gamma of R = Rz Ry Rx (deg) and C (mm); then the angle of R and
// |C|.
LossFigures EndPoseOf(const Trajectory& trajectory) {
  if (trajectory.empty()) return LossFigures(8);
  const Rigid3d first_from_last = trajectory.front().world_from_cam.Inverse() *
                                  trajectory.back().world_from_cam;
  const MotionVector motion = MotionFromRigid(first_from_last.Inverse());
  const Eigen::Vector3d angles_deg = kDegreesPerRadian * motion.head<3>();
  const Eigen::Vector3d centre_mm = kMillimetresPerMetre * motion.tail<3>();
  LossFigures figures(angles_deg.begin(), angles_deg.end());
  figures.insert(figures.end(), centre_mm.begin(), centre_mm.end());
  figures.push_back(kDegreesPerRadian * first_from_last.Angle());
  figures.push_back(centre_mm.norm());
  return figures;
}

// ATE (mm), RPE over 1 s (mm, deg), the error of the last pose (mm, deg) and
// the share of tracked frames.
LossFigures ErrorsOf(const LossRun& run) {
  LossFigures figures(5);
  if (run.evaluation.has_value()) {
    figures[0] = run.evaluation->ate.rmse * kMillimetresPerMetre;
    const RelativePoseError& relative = run.evaluation->rpe_seconds;
    if (relative.translation.count > 0) {
      figures[1] = relative.translation.rmse * kMillimetresPerMetre;
      figures[2] = relative.rotation.rmse * kDegreesPerRadian;
    }
    if (run.evaluation->final_pose.has_value()) {
      figures[3] =
          run.evaluation->final_pose->translation * kMillimetresPerMetre;
      figures[4] = run.evaluation->final_pose->angle * kDegreesPerRadian;
    }
  }
  figures.push_back(run.TrackedShare());
  return figures;
}

// Formats a table row with the given number of decimals for each cell.
std::string TableRow(const std::string& loss, const LossFigures& figures,
                     const std::vector<int>& decimals) {
  std::string text = "| " + loss + " |";
  for (size_t i = 0; i < figures.size(); ++i) {
    text += figures[i].has_value() ? Format(" %.*f |", decimals[i], *figures[i])
                                   : " n/a |";
  }
  return text + "\n";
}

}  // namespace

std::string EndPoseTable(const std::vector<LossRun>& runs,
                         bool returns_to_start) {
  std::string text =
      "| loss | alpha (deg) | beta (deg) | gamma (deg) | Cx (mm) | Cy (mm) | "
      "Cz (mm) | angle (deg) | distance (mm) |\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  if (returns_to_start) text += "| truth | 0 | 0 | 0 | 0 | 0 | 0 | 0 | 0 |\n";
  for (const LossRun& run : runs) {
    text +=
        TableRow(run.loss, EndPoseOf(run.trajectory), {4, 4, 4, 3, 3, 3, 4, 3});
  }
  return text;
}

std::string PathErrorTable(const std::vector<LossRun>& runs) {
  std::string text =
      "| loss | ATE (mm) | RPE over 1 s (mm) | RPE over 1 s (deg) | end (mm) | "
      "end (deg) | tracked (%) |\n"
      "|---|---:|---:|---:|---:|---:|---:|\n";
  for (const LossRun& run : runs) {
    LossFigures errors = ErrorsOf(run);
    *errors.back() *= 100.0;
    text += TableRow(run.loss, errors, {3, 3, 4, 3, 4, 1});
  }
  return text;
}

std::string TrackedLine(const std::vector<LossRun>& runs) {
  std::vector<std::string> shares;
  for (const LossRun& run : runs) {
    shares.push_back(run.loss + Format(" %.1f", run.TrackedShare() * 100.0));
  }
  return "Frames tracked (%): " + Join(shares) + ".\n";
}

std::string SequenceCsvRows(const std::string& name,
                            const std::vector<LossRun>& runs) {
  std::string text;
  for (const LossRun& run : runs) {
    LossFigures figures = EndPoseOf(run.trajectory);
    figures.resize(6);
    const LossFigures errors = ErrorsOf(run);
    for (const int i : {4, 3, 0, 1, 2, 5}) figures.push_back(errors[i]);
    text += "\"" + name + "\"," + run.loss;
    for (const std::optional<double>& figure : figures) {
      text += figure.has_value() ? Format(",%.6g", *figure) : ",";
    }
    text += "\n";
  }
  return text;
}

}  // namespace rgbd_pose
