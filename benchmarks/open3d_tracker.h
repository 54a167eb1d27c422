#pragma once

#include <memory>

#include "benchmarks/frame_trackers.h"

namespace rgbd_pose {

// Open3D's ComputeRGBDOdometry with its hybrid term (Park, Zhou & Koltun, ICCV
// 2017) and default settings, from frame to frame; the guess is no motion.
std::unique_ptr<FrameTracker> MakeOpen3dHybrid(const RgbdCamera& camera);

}  // namespace rgbd_pose
