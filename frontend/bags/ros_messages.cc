#include "frontend/bags/ros_messages.h"

#include <cmath>

namespace rgbd_pose {
namespace {

// In ROS 1 a frame name means the same with and without a leading slash.
std::string_view ReadFrameId(WireReader* reader) {
  std::string_view name = reader->Text();
  if (!name.empty() && name.front() == '/') name.remove_prefix(1);
  return name;
}

RosHeader ReadHeader(WireReader* reader) {
  RosHeader header;
  if (reader->format() == WireFormat::kRos1) reader->Number<uint32_t>();
  const uint32_t seconds = reader->Number<uint32_t>();
  header.stamp = seconds + 1e-9 * reader->Number<uint32_t>();
  header.frame_id = ReadFrameId(reader);
  return header;
}

template <typename Numbers>
void ReadNumbers(WireReader* reader, Numbers* numbers) {
  for (double& number : *numbers) number = reader->Number<double>();
}

}  // namespace

RosImage ReadRosImage(WireReader reader) {
  RosImage image;
  image.header = ReadHeader(&reader);
  image.height = reader.Number<uint32_t>();
  image.width = reader.Number<uint32_t>();
  image.encoding = reader.Text();
  image.is_bigendian = reader.Number<uint8_t>() != 0;
  image.step = reader.Number<uint32_t>();
  image.data = reader.Bytes();
  return image;
}

RosImage ReadRosCompressedImage(WireReader reader) {
  RosImage image;
  image.header = ReadHeader(&reader);
  image.encoding = reader.Text();
  image.data = reader.Bytes();
  return image;
}

RosCameraInfo ReadRosCameraInfo(WireReader reader) {
  RosCameraInfo info;
  info.header = ReadHeader(&reader);
  info.height = reader.Number<uint32_t>();
  info.width = reader.Number<uint32_t>();
  info.distortion_model = reader.Text();
  info.d.resize(reader.Count(sizeof(double)));
  ReadNumbers(&reader, &info.d);
  ReadNumbers(&reader, &info.k);
  std::array<double, 9> rectification;  // for stereo pairs
  ReadNumbers(&reader, &rectification);
  ReadNumbers(&reader, &info.p);
  for (uint32_t* number : {&info.binning_x, &info.binning_y, &info.x_offset,
                           &info.y_offset, &info.roi_height, &info.roi_width}) {
    *number = reader.Number<uint32_t>();
  }
  return info;
}

RosImu ReadRosImu(WireReader reader) {
  RosImu imu;
  imu.header = ReadHeader(&reader);
  std::array<double, 4> orientation;
  std::array<double, 9> covariance;
  ReadNumbers(&reader, &orientation);
  ReadNumbers(&reader, &covariance);
  ReadNumbers(&reader, &imu.gyro);
  ReadNumbers(&reader, &covariance);
  imu.has_gyro = covariance[0] != -1.0;
  ReadNumbers(&reader, &imu.accel);
  return imu;
}

Rigid3d ReadRosTransform(WireReader* reader) {
  Rigid3d motion;
  ReadNumbers(reader, &motion.translation);
  ReadNumbers(reader, &motion.rotation.coeffs());  // x y z w
  return motion;
}

std::vector<RosTransform> ReadRosTransforms(WireReader reader) {
  constexpr size_t kLeastBytes = 72;  // with empty names
  constexpr double kMaxNormError = 0.01;
  const uint32_t count = reader.Count(kLeastBytes);
  std::vector<RosTransform> transforms;
  for (uint32_t i = 0; i < count; ++i) {
    RosTransform transform;
    transform.header = ReadHeader(&reader);
    transform.child_frame_id = ReadFrameId(&reader);
    Rigid3d& motion = transform.parent_from_child;
    motion = ReadRosTransform(&reader);
    const double error = std::abs(motion.rotation.norm() - 1.0);
    if (!motion.IsFinite() || !(error < kMaxNormError)) continue;
    motion.rotation.normalize();
    transforms.push_back(transform);
  }
  return transforms;
}

}  // namespace rgbd_pose
