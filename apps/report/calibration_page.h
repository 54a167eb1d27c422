#pragma once

#include <string>

#include "apps/calibration/calibration.h"
#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// A self-contained page about a calibration: the verdict, parameters with error
// bars, residuals of held-out views over the image with both cameras, and the
// path seen from above.
std::string CalibrationPage(const CalibrationResult& result,
                            const Trajectory& path);

}  // namespace rgbd_pose
