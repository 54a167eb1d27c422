#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/estimation/frame_view.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A view of a frame for direct costs. All images are shared and must outlive
// it. `pyramid`: of frame.gray, see image_pyramid.h; `camera`: of level 0.
FrameView ViewFrame(const Frame& frame, const std::vector<cv::Mat>& pyramid,
                    const Camera& camera, const DepthNoiseModel& depth_noise);

}  // namespace rgbd_pose
