#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "apps/calibration/calibration_run.h"
#include "apps/results/run_folder.h"

namespace rgbd_pose {

// Depths that scatter by more than so many times their noise model are in the
// wrong place, not noisy.
constexpr double kMuchNoise = 5.0;

// CalibrateRecording with a progress bar for each pass.
RecordingCalibration CalibrateWithProgress(const SequenceSettings& sequence,
                                           const OdometrySettings& odometry,
                                           const SlamSettings& slam,
                                           const CalibrationSettings& settings,
                                           int threads);

// What rgbd_calibrate prints of a result.
std::string FormatCalibrationSummary(const CalibrationResult& result);

// The result for metrics.json and the report.
nlohmann::json CalibrationToJson(const CalibrationResult& result);

// What a parameter is determined to be, in words.
const char* ToString(CalibratedParameter::Status status);

// Writes what rgbd_calibrate leaves behind but for the page: camera.yaml in the
// layout of `camera` (the file or preset of the first one), depth_noise.yaml if
// there is one, metrics.json, residuals.csv, and `flags` into config.flags.
void WriteCalibration(const RecordingCalibration& calibration,
                      const std::string& camera, const std::string& flags,
                      double seconds, const RunFolder& folder);

}  // namespace rgbd_pose
