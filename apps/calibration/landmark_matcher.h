#pragma once

#include <map>
#include <memory>
#include <vector>

#include "apps/pipeline/settings.h"
#include "costs/calibration/calibration_views.h"
#include "frontend/features/frontend.h"
#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// The landmarks of one keyframe, with its views still its own.
struct LandmarksOfKeyframe {
  std::vector<Landmark> landmarks;
  std::vector<std::vector<LandmarkView>> views;  // of each landmark
};

// Finds features of keyframes in other keyframes: what one thread works with.
class LandmarkMatcher {
 public:
  // All must outlive it but `settings`. `chosen`: places in the map of the
  // keyframes, by whose numbers all is asked for.
  LandmarkMatcher(const KeyframeMap& map, const std::vector<int>& chosen,
                  const OdometrySettings& settings, int max_features);

  // `held_out`: of each of the neighbours.
  LandmarksOfKeyframe Match(int anchor, const std::vector<int>& neighbours,
                            const std::vector<bool>& held_out);

 private:
  const Rigid3d& Pose(int at) const {
    return map_.keyframes[chosen_[at]].world_from_cam;
  }
  // The pixel that was measured.
  Eigen::Vector2d Seen(const Observation& o) const {
    return map_.camera.Project(map_.camera.Ray(o.u, o.v));
  }
  // Decoded once for neighbours that follow each other.
  const PreparedFrame& Images(int at);

  // One of the keyframe's depths.
  MeasuredInverseDepth DepthOf(const Frame& frame, const Observation& o,
                               const Eigen::Vector2d& pixel) const;

  const KeyframeMap& map_;
  const std::vector<int>& chosen_;
  std::unique_ptr<Frontend> frontend_;
  DepthNoiseModel noise_;
  std::map<int, PreparedFrame> images_;
  FeatureMatches matches_;
};

}  // namespace rgbd_pose
