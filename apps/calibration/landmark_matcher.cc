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
                  const OdometrySettings& settings, int max_features)
      : map_(map), chosen_(chosen), noise_(settings.features.depth_noise) {
    FrontendOptions options = settings.features;
    options.camera = map.camera;
    options.max_features = max_features;
    frontend_ = MakeFrontend("patch", options);
  }

  // `held_out` has one entry for each neighbour.
  LandmarksOfKeyframe Match(int anchor, const std::vector<int>& neighbours,
                            const std::vector<bool>& held_out) {
    LandmarksOfKeyframe result;
    const PreparedFrame frame = Images(anchor);
    const auto features = frontend_->Detect(frame);
    std::vector<int> place(features->observations.size(), -1);
    for (size_t i = 0; i < features->observations.size(); ++i) {
      const Observation& o = features->observations[i];
      Landmark landmark;
      Measure(frame, o, &landmark);
      landmark.anchor = anchor;
      if (landmark.depth.inverse_sigma == 0.0) continue;
      place[i] = static_cast<int>(result.landmarks.size());
      result.landmarks.push_back(landmark);
    }
    result.views.resize(result.landmarks.size());
    for (size_t n = 0; n < neighbours.size(); ++n) {
      const int to = neighbours[n];
      const PreparedFrame& there = Images(to);
      frontend_->Match(*features, there, Pose(to).Inverse() * Pose(anchor),
                       &matches_);
      for (size_t i = 0; i < matches_.matches.size(); ++i) {
        const int landmark = place[matches_.features[i]];
        if (landmark < 0) continue;
        const Observation& o = matches_.matches[i].cur;
        LandmarkView view;
        Measure(there, o, &view);
        view.keyframe = to;
        view.sigma_px = o.sigma_px;
        view.is_held_out = held_out[n];
        result.views[landmark].push_back(view);
      }
    }
    return result;
  }

 private:
  const Rigid3d& Pose(int at) const {
    return map_.keyframes[chosen_[at]].world_from_cam;
  }
  void Measure(const Frame& frame, const Observation& o,
               DepthPixel* seen) const {
    const Camera& camera = map_.camera;
    const Eigen::Vector2d pixel = camera.Project(camera.Ray(o.u, o.v));
    seen->u = pixel.x();
    seen->v = pixel.y();
    seen->depth = MeasuredAt(frame, camera, o, pixel, noise_);
  }

  // Decodes images once for consecutive neighbours.
  const PreparedFrame& Images(int at) {
    constexpr size_t kMost = 40;
    const auto found = images_.find(at);
    if (found != images_.end()) return found->second;
    if (images_.size() >= kMost) {
      // The keyframe farthest in time is needed last.
      images_.erase(std::max_element(
          images_.begin(), images_.end(), [at](const auto& a, const auto& b) {
            return std::abs(a.first - at) < std::abs(b.first - at);
          }));
    }
    return images_
        .emplace(at,
                 PreparedFrame(map_.keyframes[chosen_[at]].images.Restore()))
        .first->second;
  }

  const KeyframeMap& map_;
  const std::vector<int>& chosen_;
  const DepthNoiseModel noise_;
  std::unique_ptr<Frontend> frontend_;
  std::map<int, PreparedFrame> images_;
  FeatureMatches matches_;
};

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
