#include "frontend/files/imu_file.h"

#include <algorithm>
#include <limits>

#include "core/inertial/imu_check.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/stray_imu.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

constexpr size_t kAccelColumns = 4;
constexpr size_t kAllColumns = 7;

// How much earlier than a row before it a row may be, s: programs that write
// from several threads exchange neighbours.
constexpr double kMaxDisorder = 0.1;

// Seconds since 1970 are below 2e9, nanoseconds above 1e18.
double ParseStamp(const std::string& word, const std::string& path, int line) {
  constexpr double kLeastNanoseconds = 1e15;
  const double stamp = ParseNumber(word, path, line, "the time stamp");
  return stamp > kLeastNanoseconds ? 1e-9 * stamp
                                   : ParseTimestamp(word, path, line);
}

Vector3d ParseVector(const TextLine& line, size_t first,
                     const std::string& path, const char* what) {
  Vector3d v;
  for (size_t k = 0; k < 3; ++k) {
    v[k] = ParseNumber(line.words[first + k], path, line.number, what);
  }
  return v;
}

// The first column of each part.
struct Columns {
  size_t count;  // of a row
  size_t gyro;
  size_t accel;
};

ImuSample ParseRow(const TextLine& line, const Columns& columns,
                   const std::string& path) {
  if (line.words.size() != columns.count) {
    throw InputError(path, line.number,
                     Format("%zu columns; an inertial sensor has a stamp, "
                            "angular velocity and acceleration in 7, or a "
                            "stamp and acceleration in 4, the same in all "
                            "lines",
                            line.words.size()));
  }
  ImuSample sample;
  sample.stamp = ParseStamp(line.words[0], path, line.number);
  if (columns.count == kAllColumns) {
    sample.gyro = ParseVector(line, columns.gyro, path, "an angular velocity");
  }
  sample.accel = ParseVector(line, columns.accel, path, "an acceleration");
  return sample;
}

// Sorts the samples by their stamps, and returns how many have the stamp of the
// one before and were left out.
size_t Sort(std::vector<ImuSample>* samples) {
  std::stable_sort(
      samples->begin(), samples->end(),
      [](const ImuSample& a, const ImuSample& b) { return a.stamp < b.stamp; });
  const auto end = std::unique(samples->begin(), samples->end(),
                               [](const ImuSample& a, const ImuSample& b) {
                                 return a.stamp == b.stamp;
                               });
  const size_t repeated = samples->end() - end;
  samples->erase(end, samples->end());
  return repeated;
}

}  // namespace

ImuRecording ReadImuFile(const std::string& path) {
  std::vector<TextLine> lines = ReadTextTable(path);
  const bool is_stray =
      !lines.empty() && Join(lines.front().words) == kStrayImuColumns;
  if (is_stray) lines.erase(lines.begin());
  if (lines.empty()) throw InputError(path + ": no samples");
  const bool has_gyro = lines.front().words.size() != kAccelColumns;
  const Columns columns = is_stray   ? Columns{kAllColumns, 4, 1}
                          : has_gyro ? Columns{kAllColumns, 1, 4}
                                     : Columns{kAccelColumns, 0, 1};
  ImuRecording recording;
  recording.has_gyro = has_gyro;
  double latest = std::numeric_limits<double>::lowest();
  for (const TextLine& line : lines) {
    const ImuSample sample = ParseRow(line, columns, path);
    latest = std::max(latest, sample.stamp);
    if (sample.stamp < latest - kMaxDisorder) {
      throw InputError(path, line.number,
                       "the stamp is earlier than those before; sort the file");
    }
    recording.samples.push_back(sample);
  }
  const size_t repeated = Sort(&recording.samples);
  if (is_stray) ConvertStrayImu(&recording);
  const ImuFindings findings = ExamineImu(recording.samples);
  if (!findings.error.empty()) throw InputError(path + ": " + findings.error);
  recording.warning = findings.warning;
  if (recording.warning.empty() && repeated > 0) {
    recording.warning =
        Format("%zu samples have the stamp of the one before and are left out",
               repeated);
  }
  return recording;
}

std::string FormatImuRows(const std::vector<ImuSample>& samples, bool has_gyro,
                          bool has_header) {
  std::string text;
  if (has_header) {
    text = "#timestamp [s],";
    if (has_gyro) text += "w_x [rad s^-1],w_y [rad s^-1],w_z [rad s^-1],";
    text += "a_x [m s^-2],a_y [m s^-2],a_z [m s^-2]\n";
  }
  const auto add = [&text](const Vector3d& v) {
    for (const double value : v) text += "," + ShortNumber(value);
  };
  for (const ImuSample& sample : samples) {
    text += Format("%.9f", sample.stamp);
    if (has_gyro) add(sample.gyro);
    add(sample.accel);
    text += "\n";
  }
  return text;
}

}  // namespace rgbd_pose
