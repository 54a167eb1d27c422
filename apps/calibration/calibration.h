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

// Calibrates a camera from keyframes and pairs of its recording. `first`: the
// camera that they were tracked with; `path`: a smooth path of all frames, see
// CollectCalibrationData; `known`: the camera that priors are around, null: the
// first one. Throws InputError for invalid settings.
CalibrationResult Calibrate(const KeyframeMap& map, const Trajectory& path,
                            const RgbdCamera& first,
                            const OdometrySettings& odometry,
                            const CalibrationSettings& settings,
                            const CalibrationScale& scale, int threads,
                            const RgbdCamera* known = nullptr);

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
