#include "apps/calibration/path_twist.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {
namespace {

// Longer than this between two frames, a velocity is not known.
constexpr double kMaxGap = 0.15;  // s

}  // namespace

Twist TwistAt(const Trajectory& path, double time) {
  const auto at = std::lower_bound(
      path.begin(), path.end(), time - 1e-4,
      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  if (at == path.end()) return {};
  // The last frame that comes so many after, without a gap.
  const auto place = at - path.begin();
  const auto neighbour = [&](int steps) {
    const int direction = steps > 0 ? 1 : -1;
    auto there = place;
    for (int i = 0; i < std::abs(steps); ++i) {
      const auto next = there + direction;
      if (next < 0 || next >= static_cast<std::ptrdiff_t>(path.size()) ||
          std::abs(path[next].timestamp - path[there].timestamp) > kMaxGap) {
        break;
      }
      there = next;
    }
    return there;
  };
  struct Difference {
    Twist twist;
    double interval = 0.0;  // s
    double lean = 0.0;      // how far its middle is from the frame, s
  };
  const auto difference = [&](int steps) {
    const auto before = neighbour(-steps), after = neighbour(steps);
    const double t0 = path[before].timestamp, t1 = path[after].timestamp;
    Difference result;
    result.interval = t1 - t0;
    result.lean = std::abs(0.5 * (t0 + t1) - at->timestamp);
    if (!(result.interval > 0.0)) return result;
    // Where the camera was and will be, in its own axes now.
    const auto seen = [&](std::ptrdiff_t there) {
      return TwistOf(path[there].world_from_cam.Inverse() * at->world_from_cam,
                     result.interval);
    };
    result.twist = seen(after) - seen(before);
    return result;
  };
  const Difference near = difference(1);
  const Difference far = difference(2);
  constexpr double kEven = 0.05;
  const bool is_even = std::abs(far.interval / near.interval - 2.0) < kEven &&
                       std::max(near.lean, far.lean) < kEven * near.interval;
  return is_even ? near.twist + (1.0 / 3.0) * (near.twist - far.twist)
                 : near.twist;
}

}  // namespace rgbd_pose
