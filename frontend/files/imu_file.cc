#include "frontend/files/imu_file.h"

#include "core/inertial/imu_check.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

constexpr size_t kAccelColumns = 4;
constexpr size_t kAllColumns = 7;

// Seconds since 1970 are below 2e9, nanoseconds above 1e18.
double ParseStamp(const std::string& word, const std::string& path, int line) {
  constexpr double kLeastNanoseconds = 1e15;
  const double stamp = ParseNumber(word, path, line, "the time stamp");
  return stamp > kLeastNanoseconds ? 1e-9 * stamp
                                   : ParseTimestamp(word, path, line);
}

}  // namespace

ImuRecording ReadImuFile(const std::string& path) {
  ImuRecording recording;
  size_t columns = 0;
  for (const TextLine& line : ReadTextTable(path)) {
    if (columns == 0) columns = line.words.size();
    if ((columns != kAccelColumns && columns != kAllColumns) ||
        line.words.size() != columns) {
      throw InputError(path, line.number,
                       Format("%zu columns; an inertial sensor has a stamp, "
                              "angular velocity and acceleration in 7, or a "
                              "stamp and acceleration in 4, the same in all "
                              "lines",
                              line.words.size()));
    }
    const auto vector = [&](size_t first, const char* what) {
      Eigen::Vector3d v;
      for (size_t k = 0; k < 3; ++k) {
        v[k] = ParseNumber(line.words[first + k], path, line.number, what);
      }
      return v;
    };
    ImuSample sample;
    sample.stamp = ParseStamp(line.words[0], path, line.number);
    if (columns == kAllColumns) {
      sample.gyro = vector(1, "an angular velocity");
    }
    sample.accel = vector(columns - 3, "an acceleration");
    if (!recording.samples.empty() &&
        !(sample.stamp > recording.samples.back().stamp)) {
      throw InputError(path, line.number,
                       "the stamp is not later than that of the line before");
    }
    recording.samples.push_back(sample);
  }
  if (recording.samples.empty()) throw InputError(path + ": no samples");
  recording.has_gyro = columns == kAllColumns;
  const ImuFindings findings = ExamineImu(recording.samples);
  if (!findings.error.empty()) throw InputError(path + ": " + findings.error);
  recording.warning = findings.warning;
  return recording;
}

}  // namespace rgbd_pose
