#pragma once

#include "costs/calibration/landmark_residuals.h"
#include "costs/cost_list.h"

namespace rgbd_pose {

// All residuals that a camera is calibrated by; their Jacobian tests follow
// from this list.
using CalibrationResiduals =
    TypeList<LandmarkPixel, LandmarkDepth, AnchorDepth>;

}  // namespace rgbd_pose
