#pragma once

#include "apps/calibration/calibration_data.h"
#include "apps/calibration/calibration_result.h"
#include "apps/calibration/calibration_settings.h"
#include "apps/pipeline/settings.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// Calibrates a camera from keyframes and pairs of its recording. `first`: the
// camera that they were tracked with; `path`: a smooth path of all frames, see
// CollectCalibrationData. Throws InputError for invalid settings.
CalibrationResult Calibrate(const KeyframeMap& map, const Trajectory& path,
                            const RgbdCamera& first,
                            const OdometrySettings& odometry,
                            const CalibrationSettings& settings,
                            const CalibrationScale& scale, int threads);

}  // namespace rgbd_pose
