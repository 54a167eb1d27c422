#pragma once

#include "apps/calibration/calibration_data.h"
#include "apps/calibration/calibration_result.h"
#include "apps/calibration/calibration_settings.h"
#include "apps/pipeline/settings.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "costs/calibration/calibration_parameters.h"
#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// Calibrates a camera from the keyframes and keyframe pairs of its recording.
// `first` is the camera that the keyframes were tracked with. `path` is a
// smooth path of all frames, see CollectCalibrationData. `known` is the camera
// that the priors are centred on; null means `first`. Throws InputError for
// invalid settings.
CalibrationResult Calibrate(const KeyframeMap& map, const Trajectory& path,
                            const RgbdCamera& first,
                            const OdometrySettings& odometry,
                            const CalibrationSettings& settings,
                            const CalibrationScale& scale, int threads,
                            const RgbdCamera* known = nullptr);

// A camera as calibration parameters: its lens, and no error in corrected
// depth.
CalibrationVector ThetaOf(const Camera& camera);

// Returns the first camera, changed by theta.
RgbdCamera ApplyCalibration(const RgbdCamera& first,
                            const CalibrationVector& theta);

// Returns the theta that turns the first camera into `changed`.
CalibrationVector ThetaBetween(const RgbdCamera& first,
                               const RgbdCamera& changed);

}  // namespace rgbd_pose
