#pragma once

#include <geometry_msgs/Transform.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <tf2_msgs/TFMessage.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "tests/frontend/bags/bag_fixture.h"

namespace rgbd_pose {

// Bags written by ROS' own library.
class Ros1BagTest : public BagTest {
 protected:
  static constexpr int kFrames = 20;
  static constexpr char kColor[] = "/camera/rgb/image_color";
  static constexpr char kDepth[] = "/camera/depth_registered/image_raw";
  static constexpr char kOptical[] = "/camera_rgb_optical_frame";

  void Open(
      rosbag::CompressionType compression = rosbag::compression::Uncompressed) {
    bag_.open(path_, rosbag::bagmode::Write);
    bag_.setCompression(compression);
  }

  template <typename Message>
  void Write(const std::string& topic, double received,
             const Message& message) {
    bag_.write(topic, ros::Time(received), message);
  }

  static sensor_msgs::Image MakeImage(const cv::Mat& image,
                                      const std::string& encoding, double stamp,
                                      const std::string& frame = kOptical) {
    sensor_msgs::Image message;
    message.header.stamp = ros::Time(stamp);
    message.header.frame_id = frame;
    message.height = image.rows;
    message.width = image.cols;
    message.encoding = encoding;
    // Rows with padding after their pixels.
    message.step = image.cols * image.elemSize() + 4;
    message.data.resize(message.step * message.height);
    for (int y = 0; y < image.rows; ++y) {
      std::memcpy(&message.data[y * message.step], image.ptr(y),
                  image.cols * image.elemSize());
    }
    return message;
  }

  static sensor_msgs::CompressedImage MakeCompressed(
      const std::string& format, const std::vector<uchar>& bytes,
      double stamp) {
    sensor_msgs::CompressedImage message;
    message.header.stamp = ros::Time(stamp);
    message.header.frame_id = kOptical;
    message.format = format;
    message.data = bytes;
    return message;
  }

  static sensor_msgs::CameraInfo MakeInfo(const Camera& camera) {
    sensor_msgs::CameraInfo info;
    info.width = camera.width;
    info.height = camera.height;
    info.distortion_model = "plumb_bob";
    info.D = {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
    info.K = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
    info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    info.P = {camera.fx, 0, camera.cx, 0, 0, camera.fy,
              camera.cy, 0, 0,         0, 1, 0};
    return info;
  }

  static geometry_msgs::TransformStamped MakeTransform(
      const std::string& parent, const std::string& child, double stamp,
      const Rigid3d& motion) {
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = ros::Time(stamp);
    transform.header.frame_id = parent;
    transform.child_frame_id = child;
    transform.transform = MakeMotion(motion);
    return transform;
  }

  static geometry_msgs::Transform MakeMotion(const Rigid3d& motion) {
    geometry_msgs::Transform transform;
    transform.translation.x = motion.translation.x();
    transform.translation.y = motion.translation.y();
    transform.translation.z = motion.translation.z();
    transform.rotation.x = motion.rotation.x();
    transform.rotation.y = motion.rotation.y();
    transform.rotation.z = motion.rotation.z();
    transform.rotation.w = motion.rotation.w();
    return transform;
  }

  void WriteInfo() {
    Write("/camera/rgb/camera_info", kStart, MakeInfo(SmallCamera().camera));
  }
  // Begins a bag with the calibration of the camera.
  void Begin() {
    Open();
    WriteInfo();
  }
  void WriteColor(int k) {
    Write(kColor, StampOf(k) + 0.01,
          MakeImage(ColorImage(k), "bgr8", StampOf(k)));
  }
  void WriteDepth(int k) {
    Write(kDepth, StampOf(k) + 0.011,
          MakeImage(DepthImage(k), "16UC1", StampOf(k) + 0.004));
  }
  void WriteAll() {
    WriteInfo();
    WriteFrames(kFrames);
  }
  void WriteFrames(int count) {
    for (int k = 0; k < count; ++k) {
      WriteColor(k);
      WriteDepth(k);
    }
  }

  SourceOptions Options() {
    if (bag_.isOpen()) bag_.close();
    SourceOptions options;
    options.path = path_;
    return options;
  }
  std::unique_ptr<FrameSource> Source() {
    return OpenSource("auto", Options());
  }

  void ExpectRefused(const std::vector<std::string>& parts) {
    ExpectRefusedSource(Options(), parts);
  }

  std::string path_ = folder_ / "a.bag";
  rosbag::Bag bag_;
};

}  // namespace rgbd_pose
