#pragma once

#include <vector>

#include "apps/calibration/calibration_data.h"

namespace rgbd_pose {

// The landmarks of one keyframe, with its views still its own.
struct LandmarksOfKeyframe {
  std::vector<Landmark> landmarks;
  std::vector<std::vector<LandmarkView>> views;  // of each landmark
};

// Finds up to `max_features` features of each keyframe again in those that it
// is paired with.
std::vector<LandmarksOfKeyframe> FindLandmarks(const KeyframeMap& map,
                                               const CalibrationPairs& pairs,
                                               const OdometrySettings& settings,
                                               int max_features, int threads);

}  // namespace rgbd_pose
