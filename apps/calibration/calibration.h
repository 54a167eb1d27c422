#pragma once

#include "apps/calibration/calibration_result.h"
#include "apps/calibration/calibration_settings.h"
#include "apps/pipeline/settings.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "frontend/map/keyframe_map.h"
#include "frontend/tracking/motion_guess.h"

namespace rgbd_pose {

// What else is known of where the camera was; null: nothing.
struct CalibrationScale {
  const Trajectory* ground_truth = nullptr;   // the true path
  const MotionGuess* motion_guess = nullptr;  // wheels, say
};

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

}  // namespace rgbd_pose
