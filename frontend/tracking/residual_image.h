#pragma once

#include <opencv2/core.hpp>

#include "core/estimation/frame_view.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Draws how well the pixels of a frame agree with a motion, as seen by the
// camera of the reference, in half the width and height: CV_8UC3 (blue, green,
// red). Grey where the frame agrees with the reference, red where it is
// brighter, blue where it is darker, apart from gain and bias of the whole
// image; full colour from 20 grey levels on. Black where the reference has no
// depth or the frame does not see the point.
cv::Mat DrawResiduals(const FrameView& reference, const Frame& frame,
                      const Rigid3d& cur_from_ref);

}  // namespace rgbd_pose
