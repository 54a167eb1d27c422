// Exports a run as a recording of ROS 2: an mcap file of messages in CDR that
// `ros2 bag play` publishes and Foxglove shows.

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "apps/export/export_format.h"
#include "apps/export/ros2_writer.h"
#include "apps/export/run_states.h"
#include "core/util/format.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// The poses of the path that are keyframes of the table.
Trajectory KeyframePath(const CsvTable& table, const Trajectory& path) {
  const std::vector<double> column = table.Numbers("timestamp");
  const std::set<double> times(column.begin(), column.end());
  Trajectory keyframes;
  for (const StampedPose& pose : path) {
    if (times.count(pose.timestamp) != 0) keyframes.push_back(pose);
  }
  return keyframes;
}

}  // namespace

std::string ExportMcap(const FinishedRun& run, const ExportOptions& options) {
  const Trajectory path = TimedPath(run);
  RequireWritable(options.output);
  // Images are kept in memory, because the cloud, which needs all frames, comes
  // first.
  std::map<double, EncodedImages> images;  // by time
  const ExportedViews views =
      ReadImages(run, options, [&](const Frame& frame, int view) {
        images[run.trajectory[view].timestamp] = EncodeImages(frame);
      });

  // REP 105: a map may jump, odometry does not.
  const std::optional<CsvTable> keyframes = KeyframesOf(run);
  const std::string parent = keyframes.has_value() ? "map" : "odom";
  Ros2Writer writer(parent, run.level_from_world);
  const double start = path[0].timestamp;
  writer.WritePath("/path", start, path);
  if (keyframes.has_value()) {
    writer.WritePath("/keyframes", start, KeyframePath(*keyframes, path));
  }
  writer.WriteCloud(start, views.cloud);
  for (const CameraState& state : StatesOf(run, path)) {
    writer.WriteState(state);
    const double time = state.pose.timestamp;
    const auto image = images.find(time);
    if (image == images.end()) continue;
    writer.WriteImages(time, views.camera, image->second);
  }
  WriteFileAtomically(options.output, writer.Finish());
  return Format("%zu poses in the frame %s, %zu images, %zu points in %s\n",
                path.size(), parent.c_str(), images.size(), views.cloud.size(),
                options.output.c_str()) +
         LeftOut(run.segments.size() - path.size());
}

}  // namespace rgbd_pose
