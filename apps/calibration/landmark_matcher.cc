#include "apps/calibration/landmark_matcher.h"

#include <cmath>

#include "apps/calibration/measured_depth.h"

namespace rgbd_pose {

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
    // The farthest in time will be needed last.
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

MeasuredInverseDepth LandmarkMatcher::DepthOf(
    const Frame& frame, const Observation& o,
    const Eigen::Vector2d& pixel) const {
  return MeasuredAt(frame, map_.camera, o, pixel, noise_);
}

}  // namespace rgbd_pose
