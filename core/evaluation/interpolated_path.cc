#include "core/evaluation/interpolated_path.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

constexpr double kMaxTruthGap = 0.05;  // s

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
  if (gap >= kMaxTruthGap) return std::nullopt;
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

}  // namespace rgbd_pose
