#pragma once

#include <opencv2/core.hpp>

#include "core/estimation/frame_view.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A picture of what pixels say of a motion, half as wide and high as the
// frame, as the reference's camera sees it: CV_8UC3 (blue, green, red). Gray
// where the frame shows what the reference showed, red where it is brighter,
// blue where it is darker (gain and bias of the whole image aside), full colour
// from 20 gray levels on; black where the reference has no depth or its points
// are out of the frame's view.
cv::Mat DrawResiduals(const FrameView& reference, const Frame& frame,
                      const Rigid3d& cur_from_ref);

}  // namespace rgbd_pose
