#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/bags/wire_reader.h"

namespace rgbd_pose {

// The messages of ROS that recordings of RGB-D cameras are made of, as far as
// they are used here. Texts and bytes stay in the message they were read from.

// std_msgs/Header.
struct RosHeader {
  double stamp = 0.0;         // s
  std::string_view frame_id;  // without a slash before it
};

// sensor_msgs/Image or, with a format instead of a size, CompressedImage.
struct RosImage {
  RosHeader header;
  uint32_t height = 0;
  uint32_t width = 0;
  std::string_view encoding;  // of a compressed one: its format
  bool is_bigendian = false;
  uint32_t step = 0;      // bytes a row
  std::string_view data;  // rows, or the bytes of a file
};

// sensor_msgs/CameraInfo.
struct RosCameraInfo {
  RosHeader header;
  uint32_t height = 0;
  uint32_t width = 0;
  std::string_view distortion_model;
  std::vector<double> d;       // its coefficients
  std::array<double, 9> k{};   // of the raw image, row by row
  std::array<double, 12> p{};  // of the rectified one

  // What of the full image, whose size, K and P these are, the images are: a
  // part of it (of no size: all), in which so many pixels became one (0: 1).
  uint32_t binning_x = 0;
  uint32_t binning_y = 0;
  uint32_t x_offset = 0;
  uint32_t y_offset = 0;
  uint32_t roi_height = 0;
  uint32_t roi_width = 0;
};

// geometry_msgs/TransformStamped.
struct RosTransform {
  RosHeader header;
  std::string_view child_frame_id;  // without a slash before it
  Rigid3d parent_from_child;        // parent: the header's frame
};

// These throw InputError for a message that ends too early.
RosImage ReadRosImage(WireReader reader);
RosImage ReadRosCompressedImage(WireReader reader);
RosCameraInfo ReadRosCameraInfo(WireReader reader);

// tf2_msgs/TFMessage, or tf/tfMessage of old. Leaves out what is no rigid
// motion.
std::vector<RosTransform> ReadRosTransforms(WireReader reader);

// geometry_msgs/Transform.
Rigid3d ReadRosTransform(WireReader* reader);

}  // namespace rgbd_pose
