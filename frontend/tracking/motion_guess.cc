#include "frontend/tracking/motion_guess.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {
namespace {

// Poses further apart than this (s) are not interpolated: a hand-held camera
// may have gone anywhere in between.
constexpr double kMaxGap = 0.2;

// Times beyond an end by at most this (s) are rounded stamps: the end is used.
constexpr double kMaxBeyond = 0.02;

// Interpolates between two poses with constant linear and angular velocities.
std::optional<Rigid3d> PoseAlong(const Trajectory& trajectory, double time) {
  const auto after = std::lower_bound(
      trajectory.begin(), trajectory.end(), time,
      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  if (after == trajectory.begin() || after == trajectory.end()) {
    if (trajectory.empty()) return std::nullopt;
    const StampedPose& end =
        after == trajectory.begin() ? trajectory.front() : trajectory.back();
    if (std::abs(end.timestamp - time) > kMaxBeyond) return std::nullopt;
    return end.world_from_cam;
  }
  const StampedPose& next = *after;
  const StampedPose& last = *(after - 1);
  const double gap = next.timestamp - last.timestamp;
  if (gap > kMaxGap) return std::nullopt;
  const double share = (time - last.timestamp) / gap;
  const Rigid3d& a = last.world_from_cam;
  const Rigid3d& b = next.world_from_cam;
  return Rigid3d(a.rotation.slerp(share, b.rotation),
                 a.translation + share * (b.translation - a.translation));
}

}  // namespace

std::optional<Rigid3d> MotionAlong(const Trajectory& trajectory,
                                   double prev_time, double cur_time) {
  const std::optional<Rigid3d> prev = PoseAlong(trajectory, prev_time);
  const std::optional<Rigid3d> cur = PoseAlong(trajectory, cur_time);
  if (!prev.has_value() || !cur.has_value()) return std::nullopt;
  return cur->Inverse() * *prev;
}

}  // namespace rgbd_pose
