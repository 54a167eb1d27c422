#pragma once

#include <string>
#include <vector>

#include "apps/export/camera_states.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "frontend/frame/frame.h"
#include "frontend/fusion/mesh_file.h"

namespace rgbd_pose {

// Messages of ROS 2 in CDR. `parent` is the frame of poses (map or odom), with
// x forward, y left and z up; stamps are in seconds.

// tf2_msgs/TFMessage
std::string TransformMessage(double stamp, const std::string& parent,
                             const Rigid3d& parent_from_cam);

// nav_msgs/Path
std::string PathMessage(double stamp, const Trajectory& path,
                        const std::string& parent,
                        const Rigid3d& parent_from_world);

// sensor_msgs/PointCloud2, with colours as RViz and PCL take them.
std::string CloudMessage(double stamp, const std::vector<ColoredPoint>& points,
                         const std::string& parent,
                         const Rigid3d& parent_from_world);

// nav_msgs/Odometry. Covariances are those of [position, rotation about the
// axes of the parent] and of [linear, angular] in the axes of the camera.
std::string OdometryMessage(const CameraState& state, const std::string& parent,
                            const Rigid3d& parent_from_world);

// sensor_msgs/CameraInfo
std::string CameraInfoMessage(double stamp, const Camera& camera);

// sensor_msgs/CompressedImage
std::string ImageMessage(double stamp, const std::string& format,
                         const std::string& bytes);

// Both images of a frame as CompressedImage has them.
struct EncodedImages {
  std::string color;         // JPEG
  std::string depth;         // as compressedDepth: a header, then PNG
  double depth_stamp = 0.0;  // s
};

EncodedImages EncodeImages(const Frame& frame);

}  // namespace rgbd_pose
