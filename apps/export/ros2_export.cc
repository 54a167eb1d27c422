// Exports a run as a recording of ROS 2: an mcap file of messages in CDR that
// `ros2 bag play` publishes.

#include <map>

#include "apps/export/export_format.h"
#include "apps/export/ros2_writer.h"
#include "apps/export/run_states.h"
#include "core/util/format.h"
#include "core/util/text_file.h"

namespace rgbd_pose {

std::string ExportRos2(const FinishedRun& run, const ExportOptions& options) {
  const Trajectory path = TimedPath(run, "ROS");
  RequireWritable(options.output);
  std::map<double, EncodedImages> images;  // by time
  const ExportedViews views =
      ReadImages(run, options, [&](const Frame& frame, int view) {
        images[run.trajectory[view].timestamp] = EncodeImages(frame);
      });

  // REP 105: a map may jump, odometry does not.
  const std::string parent = KeyframesOf(run).has_value() ? "map" : "odom";
  Ros2Writer writer(parent, run.level_from_world);
  writer.WritePath(path[0].timestamp, path);
  for (const CameraState& state : StatesOf(run, path)) {
    writer.WriteState(state);
    const double time = state.pose.timestamp;
    const auto image = images.find(time);
    if (image == images.end()) continue;
    writer.WriteImages(time, views.camera, image->second);
  }
  WriteFileAtomically(options.output, writer.Finish());
  return Format("%zu poses in the frame %s, %zu images in %s\n", path.size(),
                parent.c_str(), images.size(), options.output.c_str()) +
         LeftOut(run.segments.size() - path.size());
}

}  // namespace rgbd_pose
