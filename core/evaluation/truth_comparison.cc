#include "core/evaluation/truth_comparison.h"

namespace rgbd_pose {
namespace {

constexpr double kMotionTolerance = 0.05;  // s
constexpr size_t kMaxMotions = 20000;

}  // namespace

TruthComparison::TruthComparison(const Trajectory& estimate,
                                 const Trajectory& ground_truth)
    : estimate_(estimate), path_(ground_truth) {
  std::vector<std::optional<Rigid3d>> poses;
  for (const StampedPose& pose : estimate) {
    times_.push_back(pose.timestamp);
    poses.emplace_back(pose.world_from_cam);
  }
  moving_estimate_ = MovingPoses(times_, poses);
  const std::vector<PoseInterval> all =
      TimeIntervals(times_, kMotionSeconds, kMotionTolerance);
  const size_t step = all.size() / kMaxMotions + 1;
  for (size_t i = 0; i < all.size(); i += step) intervals_.push_back(all[i]);
}

std::vector<ComparedMotion> TruthComparison::Motions(
    const TruthFixing& fixing) const {
  const auto truth = MovingPoses(times_, Truth(fixing));
  const auto& estimate = moving_estimate_;
  std::vector<ComparedMotion> motions;
  for (const auto& [i, j] : intervals_) {
    if (!estimate[i] || !estimate[j] || !truth[i] || !truth[j]) continue;
    motions.push_back({times_[i], PoseChange(*estimate[i], *estimate[j]),
                       PoseChange(*truth[i], *truth[j])});
  }
  return motions;
}

std::vector<PosePair> TruthComparison::Pairs(const TruthFixing& fixing) const {
  const std::vector<std::optional<Rigid3d>> truth = Truth(fixing);
  std::vector<PosePair> pairs;
  for (size_t i = 0; i < truth.size(); ++i) {
    if (!truth[i].has_value()) continue;
    pairs.push_back({times_[i], *truth[i], estimate_[i].world_from_cam});
  }
  return pairs;
}

std::vector<std::optional<Rigid3d>> TruthComparison::Truth(
    const TruthFixing& fixing) const {
  const Rigid3d body_from_camera = fixing.camera_from_body.Inverse();
  std::vector<std::optional<Rigid3d>> poses = path_.At(times_, fixing.shift);
  for (std::optional<Rigid3d>& pose : poses) {
    if (pose.has_value()) pose = *pose * body_from_camera;
  }
  return poses;
}

}  // namespace rgbd_pose
