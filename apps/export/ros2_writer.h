#pragma once

#include <string>
#include <vector>

#include "apps/export/mcap_writer.h"
#include "apps/export/ros2_messages.h"

namespace rgbd_pose {

// Builds a recording of ROS 2 with the topics of docs/ros.md. Times (s) must
// not decrease from call to call.
class Ros2Writer {
 public:
  // `parent`: the frame of poses, map or odom. `level_from_world`: see
  // FinishedRun.
  explicit Ros2Writer(std::string parent,
                      const Rigid3d& level_from_world = Rigid3d());

  void WritePath(const std::string& topic, double time, const Trajectory& path);
  // In the axes of the world.
  void WriteCloud(double time, const std::vector<ColoredPoint>& points);
  // The transform and the odometry of a pose.
  void WriteState(const CameraState& state);
  void WriteImages(double time, const Camera& camera,
                   const EncodedImages& images);

  // As McapWriter has them.
  std::string Take() { return file_.Take(); }
  std::string Finish() { return file_.Finish(); }

 private:
  void Write(const std::string& topic, const std::string& type, double time,
             const std::string& message);

  const std::string parent_;
  const Rigid3d parent_from_world_;
  McapWriter file_;
};

}  // namespace rgbd_pose
