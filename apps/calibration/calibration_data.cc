#include "apps/calibration/calibration_data.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/twist.h"

namespace rgbd_pose {
namespace {

// Of a keyframe: as many as make the views that are wanted, since only some are
// found again, but no fewer than lie all over the image.
constexpr int kMostFeatures = 300;
constexpr int kFewestFeatures = 80;
constexpr double kFoundAgain = 0.2;

int FeaturesOfEach(int max_views, size_t num_pairs) {
  const double in_each =
      max_views / (kFoundAgain * 2.0 * std::max<double>(1.0, num_pairs));
  return static_cast<int>(
      std::clamp<double>(in_each, kFewestFeatures, kMostFeatures));
}

// Of all that were seen again as many as make the views that are wanted.
void AddLandmarks(const std::vector<LandmarksOfKeyframe>& found, int max_views,
                  CalibrationViews* views) {
  size_t all_views = 0;
  for (const LandmarksOfKeyframe& keyframe : found) {
    for (const auto& own : keyframe.views) all_views += own.size();
  }
  const double share = all_views == 0
                           ? 1.0
                           : std::min(1.0, static_cast<double>(max_views) /
                                               static_cast<double>(all_views));
  for (const LandmarksOfKeyframe& keyframe : found) {
    std::vector<size_t> seen;  // again
    for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (!keyframe.views[i].empty()) seen.push_back(i);
    }
    // Evenly chosen: they are in the order of their places in the image.
    const auto count = static_cast<size_t>(std::ceil(share * seen.size()));
    for (size_t chosen = 0; chosen < count; ++chosen) {
      const size_t i = seen[chosen * seen.size() / count];
      Landmark landmark = keyframe.landmarks[i];
      landmark.first_view = static_cast<int>(views->views.size());
      landmark.num_views = static_cast<int>(keyframe.views[i].size());
      views->landmarks.push_back(landmark);
      views->views.insert(views->views.end(), keyframe.views[i].begin(),
                          keyframe.views[i].end());
    }
  }
}

// Longer than this between two frames, a velocity is not known.
constexpr double kMaxGap = 0.15;  // s

// From a smooth path of the camera (world from camera, any world), at the time
// of one of its frames (s): central differences of the fourth order, where
// frames follow each other evenly. Zero where nothing is known.
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

}  // namespace

CalibrationData CollectCalibrationData(const KeyframeMap& map,
                                       const Trajectory& path,
                                       const OdometrySettings& settings,
                                       int max_views, int threads) {
  const CalibrationPairs chosen = ChoosePairs(map);
  CalibrationData data;
  data.views.camera = map.camera;
  data.in_map = chosen.in_map;
  data.pairs = chosen.pairs;
  for (const int place : chosen.in_map) {
    const Keyframe& keyframe = map.keyframes[place];
    data.views.world_from_cam.push_back(keyframe.world_from_cam);
    data.timestamps.push_back(keyframe.images.timestamp);
    data.views.twists.push_back(TwistAt(path, keyframe.images.timestamp));
  }
  const int features = FeaturesOfEach(max_views, data.pairs.size());
  AddLandmarks(FindLandmarks(map, chosen, settings, features, threads),
               max_views, &data.views);
  return data;
}

}  // namespace rgbd_pose
