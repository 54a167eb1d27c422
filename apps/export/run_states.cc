#include "apps/export/run_states.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "apps/results/frame_tables.h"
#include "core/util/format.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// The covariances of this run's keyframes, by time. Empty without a map, and
// without those that could not be computed.
std::map<double, MotionMatrix> KeyframeCovariances(const FinishedRun& run) {
  std::map<double, MotionMatrix> covariances;
  const std::optional<CsvTable> table = KeyframesOf(run);
  if (!table.has_value()) return covariances;
  std::vector<std::vector<double>> columns;
  for (const std::string& name :
       SplitText(std::string(kCovarianceColumns).substr(1), ',')) {
    columns.push_back(table->Numbers(name));
  }
  std::map<double, int> frames;
  for (size_t i = 0; i < run.frames.size(); ++i) {
    frames[run.trajectory[i].timestamp] = run.frames[i];
  }
  const std::vector<double> times = table->Numbers("timestamp");
  const std::vector<double> numbers = table->Numbers("keyframe");
  // Keyframes of a loaded map may have the same times, but come first. The
  // numbers of the others are those of their frames, all moved by the same.
  std::optional<double> moved;
  for (size_t row = table->size(); row-- > 0;) {
    const auto frame = frames.find(times[row]);
    if (frame == frames.end()) continue;
    const double by = numbers[row] - frame->second;
    if (by != moved.value_or(by)) continue;
    moved = by;
    if (std::isnan(columns[0][row])) continue;
    MotionMatrix& covariance = covariances[times[row]];
    auto column = columns.begin();
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) {
        covariance(i, j) = covariance(j, i) = (*column++)[row];
      }
    }
  }
  return covariances;
}

// Of each pose of the first segment: the motion that gave it, if there is one.
using Motions = std::vector<std::optional<RelativePose>>;

// Also replaces the numbers of frames in the motions by places in the path.
Motions MotionsOf(const FinishedRun& run) {
  std::map<int, int> places;  // in the path, by the number of the frame
  for (size_t i = 0; i < run.segments.size(); ++i) {
    if (run.segments[i] != run.segments[0]) continue;
    places.emplace(run.frames[i], static_cast<int>(places.size()));
  }
  Motions motions(places.size());
  for (RelativePose edge : ReadEdges(run.folder)) {
    const auto ref = places.find(edge.ref), cur = places.find(edge.cur);
    if (ref == places.end() || cur == places.end()) continue;
    if (motions[cur->second].has_value()) continue;
    edge.ref = ref->second;
    edge.cur = cur->second;
    motions[edge.cur] = edge;
  }
  return motions;
}

}  // namespace

Trajectory TimedPath(const FinishedRun& run) {
  Trajectory path;
  for (size_t i = 0; i < run.segments.size(); ++i) {
    if (run.segments[i] == run.segments[0]) path.push_back(run.trajectory[i]);
  }
  if (!IsRosTime(path[0].timestamp) || !IsRosTime(path.back().timestamp)) {
    throw InputError((run.folder.empty() ? "" : "--run: " + run.folder + ": ") +
                     "ROS has times from 1970 to 2038; export the poses with "
                     "--to=tum");
  }
  return path;
}

std::optional<CsvTable> KeyframesOf(const FinishedRun& run) {
  if (run.folder.empty()) return std::nullopt;
  const fs::path file = fs::path(run.folder) / "keyframes.csv";
  if (!fs::exists(file)) return std::nullopt;
  return CsvTable::Read(file);
}

bool IsRosTime(double seconds) {
  return seconds >= 0.0 && seconds <= std::numeric_limits<int32_t>::max();
}

double RosTime(double seconds) { return std::round(1e6 * seconds) / 1e6; }

std::string LeftOut(size_t poses) {
  if (poses == 0) return "";
  return Format(
      "%zu poses of other segments are left out: their position relative to "
      "the first segment is unknown\n",
      poses);
}

Rigid3d UprightFromLevel() {
  return Rigid3d({0.5, -0.5, 0.5, -0.5}, {0.0, 0.0, 0.0});
}

std::vector<CameraState> StatesOf(const FinishedRun& run,
                                  const Trajectory& path) {
  std::map<double, MotionMatrix> known = KeyframeCovariances(run);
  Motions motions(path.size());
  if (!run.folder.empty()) motions = MotionsOf(run);
  // The first pose is exact, unless it is in a map that was loaded.
  if (known.empty()) known[path[0].timestamp] = MotionMatrix::Zero();
  CameraStates all;
  for (size_t i = 0; i < path.size(); ++i) {
    const auto covariance = known.find(path[i].timestamp);
    all.Add(path[i], motions[i],
            covariance == known.end() ? std::nullopt
                                      : std::optional(covariance->second));
  }
  std::vector<CameraState> states;
  for (size_t i = 0; i < path.size(); ++i) states.push_back(all.At(i));
  return states;
}

}  // namespace rgbd_pose
