#pragma once

#include "core/geometry/camera.h"
#include "costs/calibration/calibration_parameters.h"

namespace rgbd_pose {

// A camera as the parameters of its calibration: its lens, and nothing wrong
// with depth as it is corrected.
CalibrationVector ThetaOf(const Camera& camera);

// The camera that was the first as theta changes it.
RgbdCamera ApplyCalibration(const RgbdCamera& first,
                            const CalibrationVector& theta);

// The theta that changes the first camera to another.
CalibrationVector ThetaBetween(const RgbdCamera& first,
                               const RgbdCamera& changed);

}  // namespace rgbd_pose
