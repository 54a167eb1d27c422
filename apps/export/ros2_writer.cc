#include "apps/export/ros2_writer.h"

#include <cmath>
#include <utility>

#include "apps/export/ros2_schemas.h"
#include "apps/export/run_states.h"

namespace rgbd_pose {

Ros2Writer::Ros2Writer(std::string parent, const Rigid3d& level_from_world)
    : parent_(std::move(parent)),
      parent_from_world_(UprightFromLevel() * level_from_world),
      file_("ros2", "cdr") {}

void Ros2Writer::WritePath(double time, const Trajectory& path) {
  Write("/path", "nav_msgs/Path", time,
        PathMessage(time, path, parent_, parent_from_world_));
}

void Ros2Writer::WriteState(const CameraState& state) {
  const double time = state.pose.timestamp;
  Write("/tf", "tf2_msgs/TFMessage", time,
        TransformMessage(time, parent_,
                         parent_from_world_ * state.pose.world_from_cam));
  Write("/odom", "nav_msgs/Odometry", time,
        OdometryMessage(state, parent_, parent_from_world_));
}

void Ros2Writer::WriteImages(double time, const Camera& camera,
                             const EncodedImages& images) {
  const std::string color = "/camera/color/";
  const std::string depth = "/camera/aligned_depth_to_color/";
  const std::string info = "sensor_msgs/CameraInfo";
  const std::string image = "sensor_msgs/CompressedImage";
  Write(color + "camera_info", info, time, CameraInfoMessage(time, camera));
  Write(color + "image_raw/compressed", image, time,
        ImageMessage(time, "bgr8; jpeg compressed bgr8", images.color));
  Write(depth + "camera_info", info, time,
        CameraInfoMessage(images.depth_stamp, camera));
  Write(depth + "image_raw/compressedDepth", image, time,
        ImageMessage(images.depth_stamp, "16UC1; compressedDepth png",
                     images.depth));
}

void Ros2Writer::Write(const std::string& topic, const std::string& type,
                       double time, const std::string& message) {
  if (!file_.HasTopic(topic)) file_.AddTopic(topic, Ros2Schema(type));
  // Times of trajectories have 6 decimals.
  file_.Write(topic, 1000 * std::llround(1e6 * time), message);
}

}  // namespace rgbd_pose
