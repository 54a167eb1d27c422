#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "core/estimation/frame_view.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Draws how a frame was tracked: CV_8UC3 (blue, green, red), the dimmed grey
// image with a strip below it for the caption and the legend. A match is a dot
// where the feature is now (cur) and a line from its place in the reference
// (prev), in the colour of its robust weight; the largest weights are on top.
// If the estimate does not have one weight per match, all are light grey. The
// caption is ASCII; text beyond about 80 characters is cut off. The size of the
// picture depends only on the image's. `camera`: of the frame.
cv::Mat DrawMatches(const Frame& frame, const Camera& camera,
                    const FeatureMatches& found, const MotionEstimate& estimate,
                    const std::string& caption);

// Draws how well the pixels of a frame agree with a motion, as seen by the
// camera of the reference, in half the width and height: CV_8UC3 (blue, green,
// red). Grey where the frame agrees with the reference, red where it is
// brighter, blue where it is darker, apart from gain and bias of the whole
// image; full colour from 20 grey levels on. Black where the reference has no
// depth or the frame does not see the point.
cv::Mat DrawResiduals(const FrameView& reference, const Frame& frame,
                      const Rigid3d& cur_from_ref);

}  // namespace rgbd_pose
