#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "apps/calibration/calibration_passes.h"
#include "apps/results/run_folder.h"

namespace rgbd_pose {

// Depths that scatter by more than so many times their noise model are in the
// wrong place, not noisy.
constexpr double kMuchNoise = 5.0;

// What rgbd_calibrate prints of a result.
std::string FormatCalibrationSummary(const CalibrationResult& result);

// The result for metrics.json and the report.
nlohmann::json CalibrationToJson(const CalibrationResult& result);

// What a parameter is determined to be, in words.
const char* ToString(CalibratedParameter::Status status);

// The folder of a calibration: camera.yaml, metrics.json, residuals.csv,
// config.flags.
class CalibrationOutput {
 public:
  // Makes the folder. Throws InputError if it cannot.
  explicit CalibrationOutput(const std::string& path) : folder_(path) {}

  // Where files are until they are published, see RunFolder.
  const std::filesystem::path& staging_dir() const {
    return folder_.staging_dir();
  }

  // Writes all files but the page. `camera`: the file or preset of the first
  // camera, whose layout the new file has.
  void Write(const RecordingCalibration& calibration, const std::string& camera,
             const std::string& flags, double seconds);

  // A further file, by its name.
  void WriteFile(const char* name, const std::string& content) const;

  // Puts all files into their places.
  void Publish() { folder_.Publish(); }

 private:
  RunFolder folder_;
};

}  // namespace rgbd_pose
