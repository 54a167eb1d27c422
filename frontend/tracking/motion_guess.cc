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

}  // namespace

std::optional<Rigid3d> MotionGuess::CurFromPrev(double prev_time,
                                                double cur_time) const {
  const std::optional<Rigid3d> prev = WorldFromCam(prev_time);
  const std::optional<Rigid3d> cur = WorldFromCam(cur_time);
  if (!prev.has_value() || !cur.has_value()) return std::nullopt;
  return cur->Inverse() * *prev;
}

// Interpolates between two poses with constant linear and angular velocities.
std::optional<Rigid3d> MotionGuess::WorldFromCam(double time) const {
  const auto after = std::lower_bound(
      trajectory_.begin(), trajectory_.end(), time,
      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  if (after == trajectory_.begin() || after == trajectory_.end()) {
    if (trajectory_.empty()) return std::nullopt;
    const StampedPose& end =
        after == trajectory_.begin() ? trajectory_.front() : trajectory_.back();
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

}  // namespace rgbd_pose
