#include "apps/compare/compare_sequence.h"

#include <cmath>

#include "core/evaluation/association.h"
#include "core/geometry/motion.h"
#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

// Figures of a run; unknown ones are empty.
using LossFigures = std::vector<std::optional<double>>;

// The last pose of a run relative to its first, in the thesis' parameters:
// alpha, beta, gamma of R = Rz Ry Rx (deg), C (mm); then the angle of R, |C|.
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

// ATE (mm), RPE over 1 s and error of the end (mm, deg each), tracked share.
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

// The truth at the times of all frames, where it has a pose close in time.
ComparedPath TruthAt(const std::vector<TrackedFrame>& frames,
                     const Trajectory& truth) {
  const std::vector<double> times = TimesOf(truth);
  ComparedPath path = {kTruthName, {}};
  for (const TrackedFrame& frame : frames) {
    ComparedPose& pose = path.poses.emplace_back();
    pose.timestamp = frame.timestamp;
    if (truth.empty()) continue;
    const size_t nearest = NearestTime(times, frame.timestamp);
    if (std::abs(times[nearest] - frame.timestamp) <=
        EvaluationOptions().max_time_difference) {
      pose.world_from_cam = truth[nearest].world_from_cam;
    }
  }
  return path;
}

// The motion that aligns a run with the truth at their first common pose.
Rigid3d WorldFromRun(const LossRun& run, const ComparedPath& truth) {
  for (size_t i = 0; i < run.frames.size(); ++i) {
    if (run.frames[i].status == TrackingStatus::kLost) continue;
    if (!truth.poses[i].world_from_cam.has_value()) continue;
    return *truth.poses[i].world_from_cam *
           run.frames[i].world_from_cam.Inverse();
  }
  return {};
}

ComparedPath PathOf(const LossRun& run, const ComparedPath& truth) {
  const Rigid3d world_from_run = WorldFromRun(run, truth);
  const std::vector<PoseError> errors =
      run.evaluation.value_or(EvaluationReport()).poses;
  auto error = errors.begin();
  ComparedPath path = {run.loss, {}};
  for (size_t i = 0; i < run.frames.size(); ++i) {
    const TrackedFrame& frame = run.frames[i];
    ComparedPose& pose = path.poses.emplace_back();
    pose.timestamp = frame.timestamp;
    if (frame.status != TrackingStatus::kLost) {
      pose.world_from_cam = world_from_run * frame.world_from_cam;
      if (truth.poses[i].world_from_cam.has_value()) {
        const Rigid3d off =
            truth.poses[i].world_from_cam->Inverse() * *pose.world_from_cam;
        pose.distance = off.translation.norm();
        pose.angle = off.Angle();
      }
    }
    if (error != errors.end() && error->timestamp == frame.timestamp) {
      pose.rpe_translation = error->rpe_translation;
      pose.rpe_rotation = error->rpe_rotation;
      ++error;
    }
  }
  return path;
}

std::string Cell(const std::optional<double>& value, double factor = 1.0) {
  return value.has_value() ? Format(",%.6f", *value * factor) : ",";
}

std::string PoseCells(const std::optional<Rigid3d>& pose) {
  if (!pose.has_value()) return ",,,,,,,";
  std::string cells;
  for (const double value : pose->translation) cells += Cell(value);
  for (const double value : pose->rotation.coeffs()) cells += Cell(value);
  return cells;
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

std::vector<ComparedPath> ComparePaths(const std::vector<LossRun>& runs,
                                       const std::optional<Trajectory>& truth) {
  const ComparedPath true_path =
      TruthAt(runs.front().frames, truth.value_or(Trajectory()));
  std::vector<ComparedPath> paths;
  if (truth.has_value()) paths.push_back(true_path);
  for (const LossRun& run : runs) paths.push_back(PathOf(run, true_path));
  return paths;
}

std::string ComparedPathsCsvRows(const std::string& name,
                                 const std::vector<ComparedPath>& paths) {
  std::string text;
  for (const ComparedPath& path : paths) {
    for (const ComparedPose& pose : path.poses) {
      text += "\"" + name + "\"," + path.name + Cell(pose.timestamp) +
              PoseCells(pose.world_from_cam) + Cell(pose.distance) +
              Cell(pose.angle, kDegreesPerRadian) + Cell(pose.rpe_translation) +
              Cell(pose.rpe_rotation, kDegreesPerRadian) + "\n";
    }
  }
  return text;
}

}  // namespace rgbd_pose
