#include "core/evaluation/moving_poses.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

constexpr double kMaxVelocitySpan = 0.25;  // s

}  // namespace

std::optional<Rigid3d> InterpolatedPath::At(double time) const {
  const auto after = std::lower_bound(
      trajectory_.begin(), trajectory_.end(), time,
      [](const StampedPose& pose, double at) { return pose.timestamp < at; });
  if (after == trajectory_.end()) return std::nullopt;
  if (after->timestamp == time) return after->world_from_cam;
  if (after == trajectory_.begin()) return std::nullopt;
  const StampedPose& before = *(after - 1);
  const double gap = after->timestamp - before.timestamp;
  if (gap >= max_gap_) return std::nullopt;
  const double share = (time - before.timestamp) / gap;
  const Rigid3d& a = before.world_from_cam;
  const Rigid3d& b = after->world_from_cam;
  return Rigid3d(a.rotation.slerp(share, b.rotation),
                 a.translation + share * (b.translation - a.translation));
}

std::vector<std::optional<Rigid3d>> InterpolatedPath::At(
    const std::vector<double>& times, double shift) const {
  std::vector<std::optional<Rigid3d>> poses;
  poses.reserve(times.size());
  for (const double time : times) poses.push_back(At(time + shift));
  return poses;
}

std::vector<std::optional<MovingPose>> MovingPoses(
    const std::vector<double>& times,
    const std::vector<std::optional<Rigid3d>>& poses) {
  std::vector<std::optional<MovingPose>> moving(poses.size());
  for (size_t i = 1; i + 1 < poses.size(); ++i) {
    const std::optional<Rigid3d>& before = poses[i - 1];
    const std::optional<Rigid3d>& after = poses[i + 1];
    if (!before || !poses[i] || !after) continue;
    const double seconds = times[i + 1] - times[i - 1];
    if (seconds > kMaxVelocitySpan) continue;
    moving[i] =
        MovingPose{*poses[i],
                   {TwistOf(after->Inverse() * *before, seconds).angular,
                    poses[i]->rotation.conjugate() *
                        (after->translation - before->translation) / seconds}};
  }
  return moving;
}

PoseChange::PoseChange(const MovingPose& from, const MovingPose& to) {
  const Rigid3d change = from.world_from_cam.Inverse() * to.world_from_cam;
  rotation = change.rotation.toRotationMatrix();
  turn = TwistOf(change, -1.0).angular;
  translation = change.translation;
  rate.angular = rotation * to.velocity.angular - from.velocity.angular;
  rate.linear = rotation * to.velocity.linear - from.velocity.linear -
                from.velocity.angular.cross(translation);
}

}  // namespace rgbd_pose
