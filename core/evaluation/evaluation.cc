#include "core/evaluation/evaluation.h"

#include <cmath>
#include <utility>

#include "core/evaluation/association.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// The path length (m) of the ground truth from the first pose to each pose.
std::vector<double> PathLengths(const std::vector<PosePair>& pairs) {
  std::vector<double> path = {0.0};
  for (size_t i = 1; i < pairs.size(); ++i) {
    path.push_back(
        path.back() +
        (pairs[i].truth.translation - pairs[i - 1].truth.translation).norm());
  }
  return path;
}

std::vector<PoseError> PoseErrors(const std::vector<PosePair>& pairs,
                                  const Rigid3d& truth_from_estimate,
                                  const std::vector<PoseInterval>& intervals) {
  std::vector<PoseError> errors;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d aligned =
        truth_from_estimate * pair.estimate.translation;
    errors.push_back(
        {pair.timestamp, (aligned - pair.truth.translation).norm(), {}, {}});
  }
  for (const auto& [i, j] : intervals) {
    const Rigid3d error = RelativeError(pairs[i], pairs[j]);
    errors[i].rpe_translation = error.translation.norm();
    errors[i].rpe_rotation = error.Angle();
  }
  return errors;
}

}  // namespace

std::string EvaluationOptions::Check() const {
  if (!(max_time_difference >= 0.0)) {
    return "the largest time difference must not be negative";
  }
  if (!std::isfinite(max_time_difference)) {
    return "the largest time difference must be finite";
  }
  // An interval shorter than its tolerance could end at its start.
  if (!(rpe_delta_seconds > max_time_difference)) {
    return "the interval of the relative error in seconds must be longer than "
           "the largest time difference";
  }
  if (!(rpe_delta_metres > 0.0)) {
    return "the interval of the relative error in metres must be positive";
  }
  for (const int frames : rpe_frames) {
    if (frames < 1) {
      return "numbers of frames of the relative error must be 1 or more";
    }
  }
  return "";
}

EvaluationReport Evaluate(const Trajectory& estimate,
                          const Trajectory& ground_truth,
                          const EvaluationOptions& options) {
  RequireSound(options.Check());
  const std::vector<PosePair> pairs =
      PairPoses(estimate, ground_truth, options.max_time_difference);
  const std::vector<double> times = TimesOf(pairs);
  const std::vector<double> path = PathLengths(pairs);

  EvaluationReport report;
  report.options = options;
  report.estimated_poses = static_cast<int>(estimate.size());
  report.paired_poses = static_cast<int>(pairs.size());
  report.duration = times.back() - times.front();
  report.path_length = path.back();
  const Rigid3d aligned = AlignRigidly(pairs);
  if (options.align) report.truth_from_estimate = aligned;
  report.sim3 = Compare(pairs, aligned);
  const std::vector<PoseInterval> intervals = TimeIntervals(
      times, options.rpe_delta_seconds, options.max_time_difference);
  report.poses = PoseErrors(pairs, report.truth_from_estimate, intervals);
  std::vector<double> distances;
  for (const PoseError& pose : report.poses) distances.push_back(pose.position);
  report.ate = Summarise(std::move(distances));
  report.rpe_frame = SummariseIntervals(pairs, FrameIntervals(pairs.size(), 1));
  report.rpe_seconds = SummariseIntervals(pairs, intervals);
  report.rpe_metres =
      SummariseIntervals(pairs, PathIntervals(path, options.rpe_delta_metres));
  for (const int frames : options.rpe_frames) {
    report.rpe_frames.push_back(
        SummariseIntervals(pairs, FrameIntervals(pairs.size(), frames)));
  }
  if (pairs.size() > 1) {
    const Rigid3d error = RelativeError(pairs.front(), pairs.back());
    report.final_pose = {error.translation.norm(), error.Angle()};
  }
  report.truth_alignment =
      AlignTruth(estimate, ground_truth, options.rpe_delta_seconds,
                 options.max_time_difference);
  return report;
}

}  // namespace rgbd_pose
