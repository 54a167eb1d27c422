#include "apps/export/run_states.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "apps/results/frame_tables.h"
#include "apps/shell/csv_table.h"
#include "core/util/format.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// The covariances of the map's keyframes, by time. Empty without a map, and
// without those that could not be computed.
std::map<double, MotionMatrix> KeyframeCovariances(const fs::path& folder) {
  std::map<double, MotionMatrix> covariances;
  const fs::path file = folder / "keyframes.csv";
  if (!fs::exists(file)) return covariances;
  const CsvTable table = CsvTable::Read(file);
  std::vector<std::vector<double>> columns;
  for (const std::string& name :
       SplitText(std::string(kCovarianceColumns).substr(1), ',')) {
    columns.push_back(table.Numbers(name));
  }
  const std::vector<double> times = table.Numbers("timestamp");
  for (size_t row = 0; row < table.size(); ++row) {
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

// The covariance of [omega C] of a motion with C in the axes of the current
// camera, too.
MotionMatrix InOwnAxes(const RelativePose& edge) {
  MotionMatrix turned = MotionMatrix::Identity();
  turned.bottomRightCorner<3, 3>() =
      edge.cur_from_ref.rotation.toRotationMatrix();
  return turned * edge.covariance * turned.transpose();
}

// The poses around a pose, for its velocity; the same twice for a single pose.
std::pair<size_t, size_t> Around(size_t place, size_t size) {
  return {place == 0 ? 0 : place - 1, std::min(place + 1, size - 1)};
}

void AddVelocities(std::vector<CameraState>* states) {
  for (size_t i = 0; i < states->size(); ++i) {
    const auto [before, after] = Around(i, states->size());
    const StampedPose& first = (*states)[before].pose;
    const StampedPose& last = (*states)[after].pose;
    const double seconds = last.timestamp - first.timestamp;
    if (!(seconds > 0.0)) continue;
    CameraState& state = (*states)[i];
    const Rigid3d& start = first.world_from_cam;
    const Rigid3d& end = last.world_from_cam;
    state.twist.angular =
        RotationVector(start.rotation.conjugate() * end.rotation) / seconds;
    state.twist.linear = state.pose.world_from_cam.rotation.conjugate() *
                         (end.translation - start.translation) / seconds;
  }
}

void AddPoseCovariances(const std::map<double, MotionMatrix>& keyframes,
                        const Motions& motions,
                        std::vector<CameraState>* states) {
  std::vector<bool> is_known(states->size(), false);
  // The first pose is exact, unless it is in a map that was loaded.
  is_known[0] = keyframes.empty();
  for (size_t i = 0; i < states->size(); ++i) {
    CameraState& state = (*states)[i];
    const auto keyframe = keyframes.find(state.pose.timestamp);
    if (keyframe != keyframes.end()) {
      state.covariance = keyframe->second;
    } else if (motions[i].has_value() && is_known[motions[i]->ref]) {
      const CameraState& reference = (*states)[motions[i]->ref];
      state.covariance = ComposedCovariance(
          motions[i]->cur_from_ref, motions[i]->covariance,
          reference.pose.world_from_cam.Inverse(), reference.covariance);
    } else {
      continue;
    }
    is_known[i] = true;
  }
}

// Both poses usually have the same reference, so that its own error is not in
// the velocity.
void AddVelocityCovariances(const Motions& motions,
                            std::vector<CameraState>* states) {
  for (size_t i = 0; i < states->size(); ++i) {
    const auto [before, after] = Around(i, states->size());
    const double seconds =
        (*states)[after].pose.timestamp - (*states)[before].pose.timestamp;
    if (!(seconds > 0.0)) continue;
    MotionMatrix covariance = MotionMatrix::Zero();
    for (const size_t end : {before, after}) {
      if (motions[end].has_value()) {
        covariance += InOwnAxes(*motions[end]) / (seconds * seconds);
      } else if (end > 0) {  // The first pose has no motion and no error.
        covariance.setZero();
        break;
      }
    }
    (*states)[i].twist_covariance = covariance;
  }
}

}  // namespace

Trajectory TimedPath(const FinishedRun& run, const std::string& asked_by) {
  Trajectory path;
  for (size_t i = 0; i < run.segments.size(); ++i) {
    if (run.segments[i] == run.segments[0]) path.push_back(run.trajectory[i]);
  }
  if (path[0].timestamp < 0.0 ||
      path.back().timestamp > std::numeric_limits<int32_t>::max()) {
    throw InputError((run.folder.empty() ? "" : "--run: " + run.folder + ": ") +
                     asked_by +
                     " has times from 1970 to 2038; export the poses with "
                     "--to=tum");
  }
  return path;
}

std::string LeftOut(const FinishedRun& run, const Trajectory& path) {
  if (path.size() == run.segments.size()) return "";
  return Format(
      "%zu poses of other segments are left out: their position relative to "
      "the first segment is unknown\n",
      run.segments.size() - path.size());
}

Rigid3d UprightFromWorld() {
  return Rigid3d({0.5, -0.5, 0.5, -0.5}, {0.0, 0.0, 0.0});
}

std::vector<CameraState> StatesOf(const FinishedRun& run,
                                  const Trajectory& path) {
  std::vector<CameraState> states(path.size());
  for (size_t i = 0; i < path.size(); ++i) states[i].pose = path[i];
  AddVelocities(&states);
  if (run.folder.empty()) return states;
  const Motions motions = MotionsOf(run);
  AddPoseCovariances(KeyframeCovariances(run.folder), motions, &states);
  AddVelocityCovariances(motions, &states);
  return states;
}

}  // namespace rgbd_pose
