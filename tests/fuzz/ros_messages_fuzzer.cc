// A message of a bag: a byte for its kind and encoding, then its bytes.

#include "frontend/bags/bag_topics.h"
#include "frontend/bags/ros_image.h"
#include "frontend/bags/ros_messages.h"
#include "tests/fuzz/fuzz_input.h"

namespace rgbd_pose {
namespace {

void ReadImage(const RosImage& image) {
  Require(image.header.stamp >= 0.0, "a time");
  UseOfEncoding(image.encoding);
  MayRefuse([&] {
    cv::Mat color;
    const cv::Mat gray = DecodeRosGray(image, "image", &color);
    Require(gray.type() == CV_8UC1 && color.type() == CV_8UC3 &&
                gray.size() == color.size() && !gray.empty(),
            "gray values and colours");
  });
  MayRefuse([&] {
    const cv::Mat depth = DecodeRosDepth(image, "image", 1000.0);
    Require(depth.type() == CV_16UC1 && !depth.empty(), "depth");
  });
}

void ReadMessage(int kind, const WireReader& reader) {
  switch (kind) {
    case 0:
      return ReadImage(ReadRosImage(reader));
    case 1:
      return ReadImage(ReadRosCompressedImage(reader));
    case 2: {
      const Camera camera =
          CameraOfInfo(ReadRosCameraInfo(reader), false, "info");
      return Require(camera.Check().empty(), "a camera");
    }
    case 4:
      return Require(ReadRosImu(reader).header.stamp >= 0.0, "a time");
    default:
      for (const RosTransform& transform : ReadRosTransforms(reader)) {
        Require(transform.parent_from_child.IsFinite(), "a motion");
      }
  }
}

}  // namespace
}  // namespace rgbd_pose

FUZZ_TARGET(ros_messages) {
  using namespace rgbd_pose;
  if (size == 0) return 0;
  const auto format = data[0] % 2 == 0 ? WireFormat::kRos1 : WireFormat::kCdr;
  MayRefuse([&] {
    ReadMessage(data[0] / 2 % 5,
                WireReader(FuzzText(data + 1, size - 1), format));
  });
  return 0;
}
