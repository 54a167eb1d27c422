#include "frontend/tracking/motion_guess.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {
namespace {

// Poses further apart than this (s) are not interpolated: a hand-held camera
// may have gone anywhere in between.
constexpr double kMaxGap = 0.21;

// Times beyond an end by at most this (s) are rounded stamps: the end is used.
constexpr double kMaxBeyond = 0.02;

std::optional<Rigid3d> PoseAlong(const Trajectory& trajectory, double time) {
  if (trajectory.empty()) return std::nullopt;
  const double inside = std::clamp(time, trajectory.front().timestamp,
                                   trajectory.back().timestamp);
  if (!(std::abs(inside - time) <= kMaxBeyond)) return std::nullopt;
  return InterpolatedPose(trajectory, inside, kMaxGap);
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
