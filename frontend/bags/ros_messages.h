#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/bags/wire_reader.h"

namespace rgbd_pose {

// The ROS messages used in recordings of RGB-D cameras, with the fields needed
// here. String views point into the message that they were read from.

// std_msgs/Header.
struct RosHeader {
  double stamp = 0.0;         // s
  std::string_view frame_id;  // without a leading slash
};

// sensor_msgs/Image, or CompressedImage, which has a format instead of a size.
struct RosImage {
  RosHeader header;
  uint32_t height = 0;
  uint32_t width = 0;
  std::string_view encoding;  // of a compressed image: its format
  bool is_bigendian = false;
  uint32_t step = 0;      // bytes per row
  std::string_view data;  // rows, or the bytes of an image file
};

// sensor_msgs/CameraInfo.
struct RosCameraInfo {
  RosHeader header;
  uint32_t height = 0;
  uint32_t width = 0;
  std::string_view distortion_model;
  std::vector<double> d;       // distortion coefficients
  std::array<double, 9> k{};   // of the raw image, row by row
  std::array<double, 12> p{};  // of the rectified image, row by row

  // The size, K and P are of the full image. The images show a part of it (size
  // 0: all) with binning_x x binning_y pixels merged into one (0 means 1).
  uint32_t binning_x = 0;
  uint32_t binning_y = 0;
  uint32_t x_offset = 0;
  uint32_t y_offset = 0;
  uint32_t roi_height = 0;
  uint32_t roi_width = 0;
};

// sensor_msgs/Imu without orientation and covariances.
struct RosImu {
  RosHeader header;
  bool has_gyro = true;   // as the first covariance says: not -1
  Eigen::Vector3d gyro;   // angular velocity, rad/s
  Eigen::Vector3d accel;  // linear acceleration, m/s^2
};

// geometry_msgs/TransformStamped.
struct RosTransform {
  RosHeader header;
  std::string_view child_frame_id;  // without a leading slash
  Rigid3d parent_from_child;        // parent: the frame of the header
};

// These throw InputError if the message ends too early.
RosImage ReadRosImage(WireReader reader);
RosImage ReadRosCompressedImage(WireReader reader);
RosCameraInfo ReadRosCameraInfo(WireReader reader);
RosImu ReadRosImu(WireReader reader);

// tf2_msgs/TFMessage or the older tf/tfMessage; only rigid transforms.
std::vector<RosTransform> ReadRosTransforms(WireReader reader);

// geometry_msgs/Transform.
Rigid3d ReadRosTransform(WireReader* reader);

}  // namespace rgbd_pose
