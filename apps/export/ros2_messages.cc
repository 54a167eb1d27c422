#include "apps/export/ros2_messages.h"

#include <vector>

#include "apps/export/export_format.h"
#include "core/util/format.h"
#include "frontend/bags/cdr_writer.h"
#include "frontend/files/jpeg_codec.h"
#include "frontend/files/png_codec.h"

namespace rgbd_pose {
namespace {

constexpr char kCamera[] = "camera_color_optical_frame";

void WriteVector(const Eigen::Vector3d& v, CdrWriter* writer) {
  writer->Numbers({v.x(), v.y(), v.z()});
}

void WritePose(const Rigid3d& pose, CdrWriter* writer) {
  const Eigen::Quaterniond& q = pose.rotation;
  WriteVector(pose.translation, writer);
  writer->Numbers({q.x(), q.y(), q.z(), q.w()});
}

void WriteMatrix(const MotionMatrix& matrix, CdrWriter* writer) {
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) writer->Number(matrix(i, j));
  }
}

}  // namespace

std::string TransformMessage(double stamp, const std::string& parent,
                             const Rigid3d& parent_from_cam) {
  CdrWriter writer;
  writer.Number(uint32_t{1}).Header(stamp, parent).Text(kCamera);
  WritePose(parent_from_cam, &writer);
  return writer.message();
}

std::string PathMessage(double stamp, const Trajectory& path,
                        const std::string& parent,
                        const Rigid3d& parent_from_world) {
  CdrWriter writer;
  writer.Header(stamp, parent);
  writer.Number(static_cast<uint32_t>(path.size()));
  for (const StampedPose& pose : path) {
    writer.Header(pose.timestamp, parent);
    WritePose(parent_from_world * pose.world_from_cam, &writer);
  }
  return writer.message();
}

std::string CloudMessage(double stamp, const std::vector<ColoredPoint>& points,
                         const std::string& parent,
                         const Rigid3d& parent_from_world) {
  constexpr uint8_t kFloat32 = 7;
  const auto count = static_cast<uint32_t>(points.size());
  CdrWriter writer;
  writer.Header(stamp, parent).Number(uint32_t{1}).Number(count);
  uint32_t point_size = 0;
  writer.Number(uint32_t{4});
  for (const char* const field : {"x", "y", "z", "rgb"}) {
    writer.Text(field).Number(point_size).Number(kFloat32).Number(uint32_t{1});
    point_size += sizeof(float);
  }
  writer.Number(uint8_t{0}).Number(point_size).Number(count * point_size);
  std::string bytes;
  for (const ColoredPoint& point : points) {
    const Eigen::Vector3d position =
        parent_from_world * point.position.cast<double>();
    for (const double x : position) {
      AppendLittleEndian(static_cast<float>(x), &bytes);
    }
    // The bytes of a number that has red above green above blue.
    bytes.append(point.color.rbegin(), point.color.rend());
    bytes.push_back('\0');
  }
  return writer.Bytes(bytes).Number(uint8_t{1}).message();
}

std::string OdometryMessage(const CameraState& state, const std::string& parent,
                            const Rigid3d& parent_from_world) {
  const Rigid3d parent_from_cam = parent_from_world * state.pose.world_from_cam;
  MotionMatrix J = MotionMatrix::Zero();
  J.topRightCorner<3, 3>() = parent_from_world.rotation.toRotationMatrix();
  J.bottomLeftCorner<3, 3>() = -parent_from_cam.rotation.toRotationMatrix();
  MotionMatrix swap = MotionMatrix::Zero();
  swap.topRightCorner<3, 3>().setIdentity();
  swap.bottomLeftCorner<3, 3>().setIdentity();
  CdrWriter writer;
  writer.Header(state.pose.timestamp, parent).Text(kCamera);
  WritePose(parent_from_cam, &writer);
  WriteMatrix(J * state.covariance * J.transpose(), &writer);
  WriteVector(state.twist.linear, &writer);
  WriteVector(state.twist.angular, &writer);
  WriteMatrix(swap * state.twist_covariance * swap.transpose(), &writer);
  return writer.message();
}

std::string CameraInfoMessage(double stamp, const Camera& camera) {
  const std::vector<double> distortion = camera.Distortion();
  const bool is_fisheye = camera.lens_model == LensModel::kEquidistant;
  const double fx = camera.fx, fy = camera.fy, cx = camera.cx, cy = camera.cy;
  CdrWriter writer;
  writer.Header(stamp, kCamera);
  writer.Number(static_cast<uint32_t>(camera.height));
  writer.Number(static_cast<uint32_t>(camera.width));
  writer.Text(is_fisheye               ? "equidistant"
              : distortion.size() == 8 ? "rational_polynomial"
                                       : "plumb_bob");
  writer.Number(static_cast<uint32_t>(distortion.size())).Numbers(distortion);
  writer.Numbers({fx, 0, cx, 0, fy, cy, 0, 0, 1});
  writer.Numbers({1, 0, 0, 0, 1, 0, 0, 0, 1});
  writer.Numbers({fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0});
  // Without binning, of the full image.
  for (int i = 0; i < 6; ++i) writer.Number(uint32_t{0});
  return writer.Number(uint8_t{0}).message();
}

std::string ImageMessage(double stamp, const std::string& format,
                         const std::string& bytes) {
  return CdrWriter().Header(stamp, kCamera).Text(format).Bytes(bytes).message();
}

EncodedImages EncodeImages(const Frame& frame) {
  // The header has parameters of floating-point depth only.
  return {EncodeJpeg(frame.color, 90),
          std::string(12, '\0') + EncodePng(DepthInMillimetres(frame)),
          frame.timestamp + frame.depth_delay};
}

}  // namespace rgbd_pose
