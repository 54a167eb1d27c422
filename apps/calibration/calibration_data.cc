#include "apps/calibration/calibration_data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/geometry/twist.h"

namespace rgbd_pose {
namespace {

// The number of features per keyframe. It is chosen for the requested number of
// views, since only a share of the features is found again, but it does not
// fall below the number that covers the whole image.
constexpr int kMostFeatures = 300;
constexpr int kFewestFeatures = 80;
constexpr double kFoundAgain = 0.2;

// Adds as many landmarks that have views as `max_views` allows.
void AddLandmarks(const std::vector<LandmarksOfKeyframe>& found, int max_views,
                  CalibrationViews* views) {
  size_t all_views = 0;
  for (const LandmarksOfKeyframe& keyframe : found) {
    for (const auto& own : keyframe.views) all_views += own.size();
  }
  const double share =
      std::min(1.0, max_views / std::max(1.0, static_cast<double>(all_views)));
  for (const LandmarksOfKeyframe& keyframe : found) {
    std::vector<size_t> seen;  // in other keyframes
    for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (!keyframe.views[i].empty()) seen.push_back(i);
    }
    // Choose evenly: landmarks are ordered by their position in the image.
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

// No velocity is computed across a longer gap between two frames.
constexpr double kMaxGap = 0.15;  // s

// The velocity (zero if unknown) from a smooth path of the camera (world from
// camera, any world) at the time of one of its frames (s): fourth-order central
// differences where frames are evenly spaced, else differences of adjacent
// frames.
Twist TwistAt(const Trajectory& path, double time) {
  const auto at = std::lower_bound(
      path.begin(), path.end(), time - 1e-4,
      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  if (at == path.end()) return {};
  // The next frame in a direction (1 or -1), or the same one before a gap.
  const auto next = [&](std::ptrdiff_t from, int direction) {
    const auto to = from + direction;
    const bool is_near =
        to >= 0 && to < static_cast<std::ptrdiff_t>(path.size()) &&
        std::abs(path[to].timestamp - path[from].timestamp) <= kMaxGap;
    return is_near ? to : from;
  };
  struct Difference {
    Twist twist;
    double interval = 0.0;  // s
    double lean = 0.0;      // offset of its middle from the frame, s
  };
  const auto difference = [&](std::ptrdiff_t before, std::ptrdiff_t after) {
    const double t0 = path[before].timestamp, t1 = path[after].timestamp;
    Difference result;
    result.interval = t1 - t0;
    result.lean = std::abs(0.5 * (t0 + t1) - at->timestamp);
    if (!(result.interval > 0.0)) return result;
    // A pose of the path, expressed in the camera frame of the given time.
    const auto seen = [&](std::ptrdiff_t there) {
      return TwistOf(path[there].world_from_cam.Inverse() * at->world_from_cam,
                     result.interval);
    };
    result.twist = seen(after) - seen(before);
    return result;
  };
  const std::ptrdiff_t place = at - path.begin();
  const auto before = next(place, -1), after = next(place, 1);
  const Difference near = difference(before, after);
  const Difference far = difference(next(before, -1), next(after, 1));
  constexpr double kEven = 0.05;
  const bool is_even = std::abs(far.interval / near.interval - 2.0) < kEven &&
                       std::max(near.lean, far.lean) < kEven * near.interval;
  return is_even ? near.twist + (1.0 / 3.0) * (near.twist - far.twist)
                 : near.twist;
}

// The work grows with the third power of the number of keyframes.
constexpr size_t kMaxKeyframes = 300;

// One pair in this number is held out for judging the result.
constexpr int kHoldOut = 5;

// The keyframes of the largest segment, as indices in the map.
std::vector<int> ChosenKeyframes(const KeyframeMap& map) {
  std::map<int, std::vector<int>> segments;
  for (size_t i = 0; i < map.keyframes.size(); ++i) {
    segments[map.keyframes[i].segment].push_back(static_cast<int>(i));
  }
  std::vector<int> largest;
  for (const auto& [segment, members] : segments) {
    if (members.size() > largest.size()) largest = members;
  }
  std::sort(largest.begin(), largest.end(), [&](int a, int b) {
    return map.keyframes[a].images.timestamp <
           map.keyframes[b].images.timestamp;
  });
  if (largest.size() <= kMaxKeyframes) return largest;
  std::vector<int> chosen;
  for (size_t i = 0; i < kMaxKeyframes; ++i) {
    chosen.push_back(largest[i * largest.size() / kMaxKeyframes]);
  }
  return chosen;
}

// Holds out one pair in kHoldOut, but none that is needed to connect keyframes.
std::vector<bool> HeldOut(int num_keyframes,
                          const std::vector<std::array<int, 2>>& pairs) {
  std::vector<int> root(num_keyframes);
  for (int i = 0; i < num_keyframes; ++i) root[i] = i;
  const auto find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::vector<bool> held_out(pairs.size(), false);
  std::vector<size_t> spare;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const int a = find(pairs[i][0]), b = find(pairs[i][1]);
    if (a == b) {
      spare.push_back(i);
    } else {
      root[a] = b;
    }
  }
  // One in kHoldOut of all pairs, if there are enough spare ones.
  const double step = std::max(
      1.0, static_cast<double>(spare.size()) * kHoldOut / pairs.size());
  for (double i = 0.0; i < spare.size(); i += step) {
    held_out[spare[static_cast<size_t>(i)]] = true;
  }
  return held_out;
}

CalibrationData ChoosePairs(const KeyframeMap& map) {
  CalibrationData result;
  result.in_map = ChosenKeyframes(map);
  const int num_keyframes = static_cast<int>(result.in_map.size());
  std::map<int, int> number_of;  // by keyframe id
  for (int i = 0; i < num_keyframes; ++i) {
    number_of[map.keyframes[result.in_map[i]].id] = i;
  }
  for (const RelativePose& edge : map.edges) {
    const auto a = number_of.find(edge.ref), b = number_of.find(edge.cur);
    if (a == number_of.end() || b == number_of.end()) continue;
    result.pairs.push_back(
        {std::min(a->second, b->second), std::max(a->second, b->second)});
  }
  std::sort(result.pairs.begin(), result.pairs.end(), [](auto& a, auto& b) {
    return std::make_pair(a[1] - a[0], a[0]) <
           std::make_pair(b[1] - b[0], b[0]);
  });
  result.pairs.erase(std::unique(result.pairs.begin(), result.pairs.end()),
                     result.pairs.end());
  result.is_held_out = HeldOut(num_keyframes, result.pairs);
  return result;
}

}  // namespace

CalibrationData CollectCalibrationData(const KeyframeMap& map,
                                       const Trajectory& path,
                                       const OdometrySettings& settings,
                                       int max_views, int threads) {
  CalibrationData data = ChoosePairs(map);
  data.views.camera = map.camera;
  for (const int place : data.in_map) {
    const Keyframe& keyframe = map.keyframes[place];
    data.views.world_from_cam.push_back(keyframe.world_from_cam);
    data.timestamps.push_back(keyframe.images.timestamp);
    data.views.twists.push_back(TwistAt(path, keyframe.images.timestamp));
  }
  const double in_each = max_views / (kFoundAgain * 2.0 *
                                      std::max<double>(1.0, data.pairs.size()));
  const int features = static_cast<int>(
      std::clamp<double>(in_each, kFewestFeatures, kMostFeatures));
  AddLandmarks(FindLandmarks(map, data, settings, features, threads), max_views,
               &data.views);
  return data;
}

}  // namespace rgbd_pose
