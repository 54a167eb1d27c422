#pragma once

#include <string>

#include "apps/calibration/calibration_result.h"

namespace rgbd_pose {

// What held-out pairs leave, as SVG pictures for a page, with the first camera
// and with the camera found: mean residuals over the image, what time a row
// seems to be late, and the spread over the speed in the image. Errors of a
// lens show in the first, those of clocks and shutters in the others.
std::string ResidualPictures(const CalibrationResult& result);

}  // namespace rgbd_pose
