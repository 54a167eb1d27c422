#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "apps/calibration/calibration_data.h"
#include "apps/calibration/displaced_depths.h"
#include "core/util/parallel_for.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {
namespace {

// Matches features of keyframes in other keyframes. Each thread has its own.
class LandmarkMatcher {
 public:
  // All arguments except `settings` must outlive the matcher. `chosen` has the
  // map indices of the keyframes; other functions use positions in `chosen`.
  LandmarkMatcher(const KeyframeMap& map, const std::vector<int>& chosen,
                  const OdometrySettings& settings, int max_features);

  // `held_out` has one entry for each neighbour.
  LandmarksOfKeyframe Match(int anchor, const std::vector<int>& neighbours,
                            const std::vector<bool>& held_out);

 private:
  const Rigid3d& Pose(int at) const {
    return map_.keyframes[chosen_[at]].world_from_cam;
  }
  // The measured (distorted) pixel.
  Eigen::Vector2d Seen(const Observation& o) const {
    return map_.camera.Project(map_.camera.Ray(o.u, o.v));
  }
  // Decodes images once for consecutive neighbours.
  const PreparedFrame& Images(int at);

  MeasuredInverseDepth DepthOf(const Frame& frame, const Observation& o,
                               const Eigen::Vector2d& pixel) const {
    return MeasuredAt(frame, map_.camera, o, pixel, noise_);
  }

  const KeyframeMap& map_;
  const std::vector<int>& chosen_;
  std::unique_ptr<Frontend> frontend_;
  DepthNoiseModel noise_;
  std::map<int, PreparedFrame> images_;
  FeatureMatches matches_;
};

LandmarkMatcher::LandmarkMatcher(const KeyframeMap& map,
                                 const std::vector<int>& chosen,
                                 const OdometrySettings& settings,
                                 int max_features)
    : map_(map), chosen_(chosen) {
  FrontendOptions options = settings.features;
  options.camera = map.camera;
  options.max_features = max_features;
  frontend_ = MakeFrontend("patch", options);
  noise_ = options.depth_noise;
}

LandmarksOfKeyframe LandmarkMatcher::Match(int anchor,
                                           const std::vector<int>& neighbours,
                                           const std::vector<bool>& held_out) {
  LandmarksOfKeyframe result;
  const PreparedFrame frame = Images(anchor);
  const auto features = frontend_->Detect(frame);
  std::vector<int> place(features->observations.size(), -1);
  for (size_t i = 0; i < features->observations.size(); ++i) {
    const Observation& o = features->observations[i];
    const Eigen::Vector2d pixel = Seen(o);
    Landmark landmark;
    landmark.anchor = anchor;
    landmark.u = pixel.x();
    landmark.v = pixel.y();
    landmark.depth = DepthOf(frame, o, pixel);
    if (landmark.depth.inverse_sigma == 0.0) continue;
    place[i] = static_cast<int>(result.landmarks.size());
    result.landmarks.push_back(landmark);
  }
  result.views.resize(result.landmarks.size());
  for (size_t n = 0; n < neighbours.size(); ++n) {
    const int to = neighbours[n];
    const PreparedFrame& there = Images(to);
    const Rigid3d cur_from_ref = Pose(to).Inverse() * Pose(anchor);
    frontend_->Match(*features, there, cur_from_ref, &matches_);
    for (size_t i = 0; i < matches_.matches.size(); ++i) {
      const int landmark = place[matches_.features[i]];
      if (landmark < 0) continue;
      const Observation& o = matches_.matches[i].cur;
      const Eigen::Vector2d pixel = Seen(o);
      LandmarkView view;
      view.keyframe = to;
      view.u = pixel.x();
      view.v = pixel.y();
      view.sigma_px = o.sigma_px;
      view.depth = DepthOf(there, o, pixel);
      view.is_held_out = held_out[n];
      result.views[landmark].push_back(view);
    }
  }
  return result;
}

const PreparedFrame& LandmarkMatcher::Images(int at) {
  constexpr size_t kMost = 40;
  const auto found = images_.find(at);
  if (found != images_.end()) return found->second;
  if (images_.size() >= kMost) {
    // The keyframe farthest in time is needed last.
    auto farthest = images_.begin();
    for (auto it = images_.begin(); it != images_.end(); ++it) {
      if (std::abs(it->first - at) > std::abs(farthest->first - at)) {
        farthest = it;
      }
    }
    images_.erase(farthest);
  }
  return images_
      .emplace(at, PreparedFrame(map_.keyframes[chosen_[at]].images.Restore()))
      .first->second;
}

}  // namespace

std::vector<LandmarksOfKeyframe> FindLandmarks(const KeyframeMap& map,
                                               const CalibrationData& chosen,
                                               const OdometrySettings& settings,
                                               int max_features, int threads) {
  const int num_keyframes = static_cast<int>(chosen.in_map.size());
  std::vector<std::vector<int>> neighbours(num_keyframes);
  std::vector<std::vector<bool>> is_held_out(num_keyframes);
  for (size_t i = 0; i < chosen.pairs.size(); ++i) {
    const auto [a, b] = chosen.pairs[i];
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
    is_held_out[a].push_back(chosen.is_held_out[i]);
    is_held_out[b].push_back(chosen.is_held_out[i]);
  }
  std::vector<LandmarksOfKeyframe> found(num_keyframes);
  threads = std::max(1, std::min(threads, num_keyframes));
  ParallelFor(threads, threads, [&](int thread) {
    // Consecutive keyframes per thread, because they share decoded neighbours.
    LandmarkMatcher matcher(map, chosen.in_map, settings, max_features);
    const int begin = thread * num_keyframes / threads;
    const int end = (thread + 1) * num_keyframes / threads;
    for (int i = begin; i < end; ++i) {
      found[i] = matcher.Match(i, neighbours[i], is_held_out[i]);
    }
  });
  return found;
}

}  // namespace rgbd_pose
