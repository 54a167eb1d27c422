#include "apps/calibration/calibration_data.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "apps/calibration/calibration_pairs.h"
#include "apps/calibration/landmark_matcher.h"
#include "apps/calibration/path_twist.h"
#include "core/util/input_error.h"
#include "core/util/parallel_for.h"

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

// Of all keyframes.
std::vector<LandmarksOfKeyframe> FindLandmarks(const KeyframeMap& map,
                                               const CalibrationPairs& pairs,
                                               const OdometrySettings& settings,
                                               int max_features, int threads) {
  const int num_keyframes = static_cast<int>(pairs.in_map.size());
  std::vector<std::vector<int>> neighbours(num_keyframes);
  std::vector<std::vector<bool>> is_held_out(num_keyframes);
  for (size_t i = 0; i < pairs.pairs.size(); ++i) {
    const auto [a, b] = pairs.pairs[i];
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
    is_held_out[a].push_back(pairs.is_held_out[i]);
    is_held_out[b].push_back(pairs.is_held_out[i]);
  }
  std::vector<LandmarksOfKeyframe> found(num_keyframes);
  threads = std::max(1, std::min(threads, num_keyframes));
  ParallelFor(threads, threads, [&](int thread) {
    // A run of keyframes each: neighbours are decoded once.
    LandmarkMatcher matcher(map, pairs.in_map, settings, max_features);
    const int begin = thread * num_keyframes / threads;
    const int end = (thread + 1) * num_keyframes / threads;
    for (int i = begin; i < end; ++i) {
      found[i] = matcher.Match(i, neighbours[i], is_held_out[i]);
    }
  });
  return found;
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

}  // namespace

std::string CalibrationDataOptions::Check() const {
  if (max_views < 1000) return "max_views must be at least 1000";
  if (max_keyframes < 2) return "max_keyframes must be at least 2";
  if (hold_out < 2) return "hold_out must be at least 2";
  return "";
}

CalibrationData CollectCalibrationData(const KeyframeMap& map,
                                       const Trajectory& path,
                                       const OdometrySettings& settings,
                                       const CalibrationDataOptions& options,
                                       int threads) {
  const std::string error = options.Check();
  if (!error.empty()) throw InputError("calibration: " + error);
  const CalibrationPairs chosen =
      ChoosePairs(map, options.max_keyframes, options.hold_out);
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
  const int features = FeaturesOfEach(options.max_views, data.pairs.size());
  AddLandmarks(FindLandmarks(map, chosen, settings, features, threads),
               options.max_views, &data.views);
  return data;
}

}  // namespace rgbd_pose
