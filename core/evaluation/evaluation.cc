#include "core/evaluation/evaluation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/evaluation/alignment.h"
#include "core/evaluation/pose_pairs.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// From the place of one paired pose to that of a later one.
using Interval = std::pair<size_t, size_t>;

ErrorStatistics Summarise(std::vector<double> errors) {
  ErrorStatistics result;
  if (errors.empty()) return result;
  std::sort(errors.begin(), errors.end());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  const size_t n = errors.size();
  result.count = static_cast<int>(n);
  result.rmse = std::sqrt(sum_of_squares / n);
  result.mean = sum / n;
  result.median = (errors[(n - 1) / 2] + errors[n / 2]) / 2.0;
  result.max = errors.back();
  return result;
}

// E of RelativePoseError.
Rigid3d RelativeError(const PosePair& i, const PosePair& j) {
  const Rigid3d truth_i_from_j = i.truth.Inverse() * j.truth;
  const Rigid3d estimate_i_from_j = i.estimate.Inverse() * j.estimate;
  return truth_i_from_j.Inverse() * estimate_i_from_j;
}

RelativePoseError SummariseIntervals(const std::vector<PosePair>& pairs,
                                     const std::vector<Interval>& intervals) {
  std::vector<double> translations;
  std::vector<double> angles;
  for (const auto& [i, j] : intervals) {
    const Rigid3d error = RelativeError(pairs[i], pairs[j]);
    translations.push_back(error.translation.norm());
    angles.push_back(error.Angle());
  }
  return {Summarise(std::move(translations)), Summarise(std::move(angles))};
}

std::vector<Interval> FrameIntervals(size_t size) {
  std::vector<Interval> intervals;
  for (size_t i = 0; i + 1 < size; ++i) intervals.emplace_back(i, i + 1);
  return intervals;
}

std::vector<Interval> TimeIntervals(const std::vector<double>& times,
                                    double delta, double max_difference) {
  std::vector<Interval> intervals;
  for (size_t i = 0; i < times.size(); ++i) {
    const double end = times[i] + delta;
    const size_t j = NearestTime(times, end);
    if (std::abs(times[j] - end) <= max_difference) {
      intervals.emplace_back(i, j);
    }
  }
  return intervals;
}

std::vector<Interval> PathIntervals(const std::vector<double>& path,
                                    double delta) {
  // Ten steps of 0.1 m make 1 m, whatever rounding says.
  constexpr double kRounding = 1e-9;
  std::vector<Interval> intervals;
  size_t j = 0;
  for (size_t i = 0; i < path.size(); ++i) {
    while (j < path.size() && path[j] - path[i] < delta - kRounding) ++j;
    if (j == path.size()) break;
    intervals.emplace_back(i, j);
  }
  return intervals;
}

std::vector<double> Times(const std::vector<PosePair>& pairs) {
  std::vector<double> times;
  times.reserve(pairs.size());
  for (const PosePair& pair : pairs) times.push_back(pair.timestamp);
  return times;
}

// The length (m) of the ground truth's path from the first pose to each.
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
                                  const std::vector<Interval>& intervals) {
  std::vector<PoseError> errors;
  for (const PosePair& pair : pairs) {
    PoseError error;
    error.timestamp = pair.timestamp;
    const Eigen::Vector3d aligned =
        truth_from_estimate * pair.estimate.translation;
    error.position = (aligned - pair.truth.translation).norm();
    errors.push_back(error);
  }
  for (const auto& [i, j] : intervals) {
    const Rigid3d error = RelativeError(pairs[i], pairs[j]);
    errors[i].rpe_translation = error.translation.norm();
    errors[i].rpe_rotation = error.Angle();
  }
  return errors;
}

ErrorStatistics AbsoluteError(const std::vector<PoseError>& poses) {
  std::vector<double> errors;
  errors.reserve(poses.size());
  for (const PoseError& pose : poses) errors.push_back(pose.position);
  return Summarise(std::move(errors));
}

}  // namespace

std::string EvaluationOptions::Check() const {
  if (!(max_time_difference >= 0.0)) {
    return "the largest time difference must not be negative";
  }
  // An interval shorter than its tolerance could end where it starts.
  if (!(rpe_delta_seconds > max_time_difference)) {
    return "the interval of the relative error in seconds must be longer than "
           "the largest time difference";
  }
  if (!(rpe_delta_metres > 0.0)) {
    return "the interval of the relative error in metres must be positive";
  }
  return "";
}

EvaluationReport Evaluate(const Trajectory& estimate,
                          const Trajectory& ground_truth,
                          const EvaluationOptions& options) {
  const std::string problem = options.Check();
  if (!problem.empty()) throw InputError(problem);
  const std::vector<PosePair> pairs =
      PairPoses(estimate, ground_truth, options.max_time_difference);
  const std::vector<double> times = Times(pairs);
  const std::vector<double> path = PathLengths(pairs);

  EvaluationReport report;
  report.options = options;
  report.estimated_poses = static_cast<int>(estimate.size());
  report.paired_poses = static_cast<int>(pairs.size());
  report.duration = times.back() - times.front();
  report.path_length = path.back();
  report.truth_from_estimate = AlignRigidly(pairs);
  report.likeness = Compare(pairs, report.truth_from_estimate);
  const std::vector<Interval> intervals = TimeIntervals(
      times, options.rpe_delta_seconds, options.max_time_difference);
  report.poses = PoseErrors(pairs, report.truth_from_estimate, intervals);
  report.ate = AbsoluteError(report.poses);
  report.rpe_frame = SummariseIntervals(pairs, FrameIntervals(pairs.size()));
  report.rpe_seconds = SummariseIntervals(pairs, intervals);
  report.rpe_metres =
      SummariseIntervals(pairs, PathIntervals(path, options.rpe_delta_metres));
  if (pairs.size() > 1) {
    const Rigid3d error = RelativeError(pairs.front(), pairs.back());
    report.final_pose = {error.translation.norm(), error.Angle()};
  }
  return report;
}

}  // namespace rgbd_pose
