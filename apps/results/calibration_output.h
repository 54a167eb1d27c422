#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "frontend/calibration/calibration_run.h"

namespace rgbd_pose {

// Calls CalibrateRecording and shows its progress for each pass.
RecordingCalibration CalibrateWithProgress(const SequenceSettings& sequence,
                                           const OdometrySettings& odometry,
                                           const SlamSettings& slam,
                                           const CalibrationSettings& settings,
                                           int threads);

// Formats a result as rgbd_calibrate prints it.
std::string FormatCalibrationSummary(const CalibrationResult& result);

// Formats the result for metrics.json and the report.
nlohmann::json CalibrationToJson(const CalibrationResult& result);

const char* ToString(CalibratedParameter::Status status);

}  // namespace rgbd_pose
