#pragma once

#include "apps/calibration/calibration_run.h"

namespace rgbd_pose {

// CalibrateRecording with a progress bar for each pass.
RecordingCalibration CalibrateWithProgress(const SequenceSettings& sequence,
                                           const OdometrySettings& odometry,
                                           const SlamSettings& slam,
                                           const CalibrationSettings& settings,
                                           int threads);

}  // namespace rgbd_pose
