#pragma once

#include <string>

#include "apps/calibration/calibration.h"
#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// A page on a calibration that needs nothing else: the verdict, parameters with
// error bars, what is left of held-out views over the image with either camera,
// and the path from above.
std::string CalibrationPage(const CalibrationResult& result,
                            const Trajectory& path);

}  // namespace rgbd_pose
