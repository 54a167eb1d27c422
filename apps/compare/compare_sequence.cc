#include "apps/compare/compare_sequence.h"

#include <glog/logging.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "apps/pipeline/sequence.h"
#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "core/geometry/motion.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

// The last pose of a run seen from its first, in the thesis' parameters.
struct EndPose {
  Eigen::Vector3d angles_deg;  // alpha, beta, gamma of R = Rz Ry Rx
  Eigen::Vector3d centre_mm;   // C
  double angle_deg = 0.0;      // of R
};

std::optional<EndPose> EndPoseOf(const Trajectory& trajectory) {
  if (trajectory.empty()) return std::nullopt;
  const Rigid3d first_from_last = trajectory.front().world_from_cam.Inverse() *
                                  trajectory.back().world_from_cam;
  const MotionVector motion = MotionFromRigid(first_from_last.Inverse());
  return EndPose{kDegreesPerRadian * motion.head<3>(),
                 kMillimetresPerMetre * motion.tail<3>(),
                 kDegreesPerRadian * first_from_last.Angle()};
}

// What tables say of one run; empty where there is nothing to judge.
struct PathErrors {
  std::optional<double> ate_mm;
  std::optional<double> rpe_mm;  // over 1 s
  std::optional<double> rpe_deg;
  std::optional<double> end_mm;
  std::optional<double> end_deg;
};

PathErrors ErrorsOf(const LossRun& run) {
  PathErrors errors;
  if (!run.evaluation.has_value()) return errors;
  errors.ate_mm = run.evaluation->ate.rmse * kMillimetresPerMetre;
  const RelativePoseError& relative = run.evaluation->rpe_seconds;
  if (relative.translation.count > 0) {
    errors.rpe_mm = relative.translation.rmse * kMillimetresPerMetre;
    errors.rpe_deg = relative.rotation.rmse * kDegreesPerRadian;
  }
  if (run.evaluation->final_pose.has_value()) {
    errors.end_mm =
        run.evaluation->final_pose->translation * kMillimetresPerMetre;
    errors.end_deg = run.evaluation->final_pose->angle * kDegreesPerRadian;
  }
  return errors;
}

// A cell of a table with so many decimals.
std::string Cell(const std::optional<double>& value, int decimals) {
  return value.has_value() ? Format(" %.*f |", decimals, *value) : " n/a |";
}

void AddCsvCell(const std::optional<double>& value, std::string* row) {
  *row += value.has_value() ? Format(",%.6g", *value) : ",";
}

}  // namespace

std::vector<LossRun> CompareLosses(FrameSource* source,
                                   const std::optional<Trajectory>& truth,
                                   const std::vector<std::string>& losses,
                                   OdometrySettings settings, int threads) {
  if (truth.has_value()) RequireOverlap(*source, *truth);
  std::vector<OdometryRun> runs;
  for (const std::string& loss : losses) {
    settings.estimator.loss = loss;
    runs.emplace_back(settings, source->camera().camera);
  }
  std::vector<SequenceRun*> all;
  for (OdometryRun& run : runs) all.push_back(&run);
  {
    ProgressBar bar("tracking", static_cast<int>(source->timestamps().size()));
    const std::string stopped =
        TrackAll(source, threads, all, [&bar](const Frame& frame) {
          bar.Update(frame.index + 1);
          return true;
        });
    Warn(DroppedFrames(*source, all[0]->damaged()));
    if (!stopped.empty()) LOG(WARNING) << "ended early: " << stopped;
  }
  std::vector<LossRun> results;
  for (size_t i = 0; i < losses.size(); ++i) {
    results.push_back(
        {runs[i].Finish(truth.has_value() ? &*truth : nullptr), losses[i]});
  }
  return results;
}

std::string EndPoseTable(const std::vector<LossRun>& runs,
                         bool returns_to_start) {
  std::string text =
      "| loss | alpha (deg) | beta (deg) | gamma (deg) | Cx (mm) | Cy (mm) | "
      "Cz (mm) | angle (deg) | distance (mm) |\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  if (returns_to_start) text += "| truth | 0 | 0 | 0 | 0 | 0 | 0 | 0 | 0 |\n";
  for (const LossRun& run : runs) {
    const std::optional<EndPose> end = EndPoseOf(run.trajectory);
    text += "| " + run.loss + " |";
    if (!end.has_value()) {
      for (int i = 0; i < 8; ++i) text += Cell(std::nullopt, 0);
    } else {
      for (const double angle : end->angles_deg) text += Cell(angle, 4);
      for (const double length : end->centre_mm) text += Cell(length, 3);
      text += Cell(end->angle_deg, 4) + Cell(end->centre_mm.norm(), 3);
    }
    text += "\n";
  }
  return text;
}

std::string PathErrorTable(const std::vector<LossRun>& runs) {
  std::string text =
      "| loss | ATE (mm) | RPE over 1 s (mm) | RPE over 1 s (deg) | end (mm) | "
      "end (deg) | tracked (%) |\n"
      "|---|---:|---:|---:|---:|---:|---:|\n";
  for (const LossRun& run : runs) {
    const PathErrors errors = ErrorsOf(run);
    text += "| " + run.loss + " |" + Cell(errors.ate_mm, 3) +
            Cell(errors.rpe_mm, 3) + Cell(errors.rpe_deg, 4) +
            Cell(errors.end_mm, 3) + Cell(errors.end_deg, 4) +
            Cell(run.TrackedShare() * 100.0, 1) + "\n";
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

const char kSequenceCsvHeader[] =
    "sequence,loss,alpha_deg,beta_deg,gamma_deg,cx_mm,cy_mm,cz_mm,end_deg,"
    "end_mm,ate_mm,rpe_seconds_mm,rpe_seconds_deg,tracked_share\n";

std::string SequenceCsvRows(const std::string& name,
                            const std::vector<LossRun>& runs) {
  std::string text;
  for (const LossRun& run : runs) {
    const std::optional<EndPose> end = EndPoseOf(run.trajectory);
    const PathErrors errors = ErrorsOf(run);
    std::string row = "\"" + name + "\"," + run.loss;
    for (int i = 0; i < 3; ++i) {
      AddCsvCell(end ? std::optional(end->angles_deg(i)) : std::nullopt, &row);
    }
    for (int i = 0; i < 3; ++i) {
      AddCsvCell(end ? std::optional(end->centre_mm(i)) : std::nullopt, &row);
    }
    for (const std::optional<double>& value :
         {errors.end_deg, errors.end_mm, errors.ate_mm, errors.rpe_mm,
          errors.rpe_deg, std::optional(run.TrackedShare())}) {
      AddCsvCell(value, &row);
    }
    text += row + "\n";
  }
  return text;
}

}  // namespace rgbd_pose
