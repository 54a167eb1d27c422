#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "core/estimation/motion_estimate.h"
#include "core/geometry/camera.h"
#include "frontend/features/frontend.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A picture of how a frame was tracked: CV_8UC3 (blue, green, red), the dimmed
// grey image with a strip below it for the caption and the legend. A match is a
// dot where the feature is now (cur) and a line from where it was in the
// reference (prev), in the colour of its robust weight; the best are on top.
// If the estimate does not hold one weight a match, all are light grey.
//
// `camera` is that of the frame: it puts the undistorted observations back into
// the image as it was taken. The caption is ASCII; what is longer than about
// 80 characters is cut. The size of the picture depends on that of the image
// only, so that the pictures of a sequence make a film.
cv::Mat DrawMatches(const Frame& frame, const Camera& camera,
                    const FeatureMatches& found, const MotionEstimate& estimate,
                    const std::string& caption);

}  // namespace rgbd_pose
