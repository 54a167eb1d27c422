#include "frontend/bags/ros1_bag.h"

#include <geometry_msgs/Transform.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Float32.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "core/util/text_file.h"
#include "frontend/sources/open_source.h"
#include "frontend/sources/tum_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

constexpr int kFrames = 20;
constexpr double kStart = 1000.0;
constexpr char kColor[] = "/camera/rgb/image_color";
constexpr char kDepth[] = "/camera/depth_registered/image_raw";
constexpr char kOptical[] = "/camera_rgb_optical_frame";

double StampOf(int k) { return kStart + k / 30.0; }

// Written by ROS' own library.
class Ros1BagTest : public testing::Test {
 protected:
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
    // Rows that are longer than their pixels.
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
    for (int k = 0; k < kFrames; ++k) {
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

  // All frames, as they were written.
  static void ExpectFrames(FrameSource* source, int count = kFrames,
                           double depth_scale = 1000.0) {
    EXPECT_EQ(source->camera().depth_scale, depth_scale);
    EXPECT_EQ(source->camera().camera.cx, SmallCamera().camera.cx);
    for (int k = 0; k < count; ++k) {
      const std::optional<RgbdFrame> next = source->Next();
      ASSERT_TRUE(next.has_value()) << k;
      EXPECT_NEAR(next->timestamp, StampOf(k), 1e-6);
      const Frame frame = next->read();
      EXPECT_EQ(frame.index, k);
      EXPECT_NEAR(frame.depth_delay, 0.004, 1e-6);
      EXPECT_EQ(frame.depth.at<uint16_t>(5, 5),
                std::lround((1000 + k) * depth_scale / 1000.0));
      EXPECT_NEAR(frame.gray.at<uint8_t>(5, 5), 68 + k, 3);
    }
    EXPECT_FALSE(source->Next().has_value());
  }

  void ExpectRefused(const std::vector<std::string>& parts) {
    const SourceOptions options = Options();
    ExpectInputError(
        [&] {
          const auto source = OpenSource("auto", options);
          while (const auto next = source->Next()) next->read();
        },
        parts);
  }

  TempFolder folder_;
  std::string path_ = folder_ / "a.bag";
  rosbag::Bag bag_;
};

TEST_F(Ros1BagTest, ReadsFrames) {
  Open();
  WriteAll();
  const auto source = Source();
  ExpectFrames(source.get());
  EXPECT_EQ(source->unmatched_color(), 0);
  EXPECT_TRUE(source->ground_truth().empty());
  EXPECT_TRUE(source->timestamps().empty());
}

TEST_F(Ros1BagTest, ReadsPackedOnes) {
  for (const auto compression :
       {rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    Open(compression);
    WriteAll();
    ExpectFrames(Source().get());
  }
}

TEST_F(Ros1BagTest, ReadsColours) {
  struct Case {
    const char* encoding;
    cv::Scalar value;
    int type;
    cv::Vec3b bgr;
  };
  for (const Case& c : {Case{"rgb8", {30, 20, 10}, CV_8UC3, {10, 20, 30}},
                        Case{"bgr8", {10, 20, 30}, CV_8UC3, {10, 20, 30}},
                        Case{"rgba8", {30, 20, 10, 255}, CV_8UC4, {10, 20, 30}},
                        Case{"bgra8", {10, 20, 30, 255}, CV_8UC4, {10, 20, 30}},
                        Case{"mono8", {20}, CV_8UC1, {20, 20, 20}}}) {
    Open();
    WriteInfo();
    const cv::Mat image(kHeight, kWidth, c.type, c.value);
    Write(kColor, kStart, MakeImage(image, c.encoding, kStart));
    Write(kDepth, kStart, MakeImage(DepthImage(0), "16UC1", kStart));
    SourceOptions options = Options();
    options.keep_color = true;
    const Frame frame = OpenSource("rosbag", options)->Next()->read();
    EXPECT_EQ(frame.color.at<cv::Vec3b>(3, 4), c.bgr) << c.encoding;
    EXPECT_NEAR(frame.gray.at<uint8_t>(3, 4),
                0.114 * c.bgr[0] + 0.587 * c.bgr[1] + 0.299 * c.bgr[2], 1.0);
  }
}

TEST_F(Ros1BagTest, ReadsMetres) {
  Open();
  WriteInfo();
  for (int k = 0; k < kFrames; ++k) {
    WriteColor(k);
    cv::Mat metres;
    DepthImage(k).convertTo(metres, CV_32F, 0.001);
    metres.at<float>(0, 0) = NAN;
    metres.at<float>(0, 1) = 13.2F;  // too far
    Write("/camera/depth/image", StampOf(k) + 0.02,
          MakeImage(metres, "32FC1", StampOf(k) + 0.004));
  }
  ExpectFrames(Source().get(), kFrames, 5000.0);
  const Frame frame = Source()->Next()->read();
  EXPECT_EQ(frame.depth.at<uint16_t>(0, 0), 0);
  EXPECT_EQ(frame.depth.at<uint16_t>(0, 1), 0);

  SourceOptions options = Options();
  options.depth_scale = 2000.0;
  ExpectFrames(OpenSource("auto", options).get(), kFrames, 2000.0);
}

TEST_F(Ros1BagTest, ReadsCompressedImages) {
  for (const bool is_metric : {false, true}) {
    Open();
    WriteInfo();
    for (int k = 0; k < kFrames; ++k) {
      std::vector<uchar> bytes;
      cv::imencode(k % 2 == 0 ? ".jpg" : ".png", ColorImage(k), bytes);
      Write(std::string(kColor) + "/compressed", StampOf(k),
            MakeCompressed("bgr8; jpeg compressed bgr8", bytes, StampOf(k)));
      // What compressed_depth_image_transport writes: depth as A / z + B.
      const float a = 10100.0F;
      const float b = -100.0F;
      cv::Mat depth = DepthImage(k);
      if (is_metric) {
        depth.forEach<uint16_t>([&](uint16_t& raw, const int*) {
          if (raw > 0) raw = std::lround(a / (raw * 0.001F) + b);
        });
      }
      std::vector<uchar> png;
      cv::imencode(".png", depth, png);
      std::vector<uchar> message(12);
      std::memcpy(&message[4], &a, 4);
      std::memcpy(&message[8], &b, 4);
      message.insert(message.end(), png.begin(), png.end());
      Write(std::string(kDepth) + "/compressedDepth", StampOf(k),
            MakeCompressed(is_metric ? "32FC1; compressedDepth png"
                                     : "16UC1; compressedDepth png",
                           message, StampOf(k) + 0.004));
    }
    if (!is_metric) {
      ExpectFrames(Source().get());
      continue;
    }
    const Frame frame = Source()->Next()->read();
    EXPECT_NEAR(frame.DepthAt(5, 5), 1.0, 2e-4);  // as fine as it is packed
    EXPECT_EQ(frame.DepthAt(0, 0), 0.0);
  }
}

TEST_F(Ros1BagTest, PrefersRegisteredDepthAndRawImages) {
  Open();
  WriteAll();
  Write("/camera/depth/image_raw", kStart,
        MakeImage(DepthImage(50), "16UC1", kStart));
  Write("/camera/ir/image_raw", kStart,
        MakeImage(cv::Mat(kHeight, kWidth, CV_8UC1), "mono8", kStart));
  Write("/camera/rgb/image_color/compressed", kStart,
        MakeCompressed("bgr8; jpeg", {1, 2, 3}, kStart));
  ExpectFrames(Source().get());
}

TEST_F(Ros1BagTest, AsksWhichTopicsWhereSeveralWillDo) {
  Open();
  WriteAll();
  Write("/other/depth_registered/image", kStart,
        MakeImage(DepthImage(50), "16UC1", kStart));
  ExpectRefused({"a.bag: both " + std::string(kDepth),
                 "/other/depth_registered/image", "topics=COLOUR,DEPTH",
                 kColor});
  SourceOptions options = Options();
  options.topics = {kColor, kDepth};
  ExpectFrames(OpenSource("auto", options).get());
  options.topics.emplace_back("/camera/rgb/camera_info");
  ExpectFrames(OpenSource("auto", options).get());
  options.topics[1] = "/nothing";
  ExpectInputError([&] { OpenSource("auto", options); },
                   {"no topic '/nothing'", kDepth});
  options.topics[1] = "/camera/rgb/camera_info";
  ExpectInputError([&] { OpenSource("auto", options); },
                   {"of the type sensor_msgs/CameraInfo"});
  options.topics = {kColor};
  ExpectInputError([&] { OpenSource("auto", options); }, {"COLOUR,DEPTH"});
}

TEST_F(Ros1BagTest, SortsWhatIsSlightlyOutOfOrder) {
  Open();
  WriteInfo();
  for (int k = 0; k < kFrames; ++k) {
    const int other = k ^ 1;  // pairs of neighbours change places
    Write(kColor, StampOf(k),
          MakeImage(ColorImage(other), "bgr8", StampOf(other)));
    Write(kDepth, StampOf(k) + 0.2,  // recorded much later
          MakeImage(DepthImage(k), "16UC1", StampOf(k) + 0.004));
  }
  ExpectFrames(Source().get());
}

TEST_F(Ros1BagTest, RefusesWhatIsFarOutOfOrder) {
  Open();
  WriteInfo();
  for (int k = 0; k < 40; ++k) {
    const int other = (k + 20) % 40;
    Write(kColor, StampOf(k), MakeImage(ColorImage(k), "bgr8", StampOf(other)));
    Write(kDepth, StampOf(k),
          MakeImage(DepthImage(k), "16UC1", StampOf(other)));
  }
  ExpectRefused({"a.bag: ", kColor, "out of order", "header stamps"});
}

TEST_F(Ros1BagTest, LeavesOutImagesWithoutPairs) {
  Open();
  WriteInfo();
  for (int k = 0; k < kFrames; ++k) {
    WriteColor(k);
    if (k != 3 && k < 10) WriteDepth(k);
  }
  const auto source = Source();
  int frames = 0;
  while (source->Next().has_value()) ++frames;
  EXPECT_EQ(frames, 9);
  EXPECT_EQ(source->unmatched_color(), kFrames - 9);
}

TEST_F(Ros1BagTest, MotionCaptureIsTheGroundTruth) {
  const Rigid3d kinect_from_camera(Eigen::Quaterniond(Eigen::AngleAxisd(
                                       -M_PI / 2, Eigen::Vector3d::UnitX())),
                                   {0.1, 0.0, 0.0});
  Open();
  WriteInfo();
  for (int k = 0; k < kFrames; ++k) {
    WriteColor(k);
    WriteDepth(k);
    tf2_msgs::TFMessage message;
    message.transforms.push_back(MakeTransform(
        "/world", "/kinect", StampOf(k), {{1, 0, 0, 0}, {0.01 * k, 0, 1}}));
    message.transforms.push_back(
        MakeTransform("/kinect", kOptical, StampOf(k), kinect_from_camera));
    Write("/tf", StampOf(k), message);
  }
  const auto source = Source();
  EXPECT_TRUE(source->ground_truth().empty()) << "nothing is read yet";
  ExpectFrames(source.get());
  const Trajectory truth = source->ground_truth();
  ASSERT_EQ(truth.size(), static_cast<size_t>(kFrames));
  for (int k = 0; k < kFrames; ++k) {
    EXPECT_NEAR(truth[k].timestamp, StampOf(k), 1e-6);
    const Eigen::Vector3d ahead =
        truth[k].world_from_cam * Eigen::Vector3d(0, 0, 2);
    EXPECT_LT((ahead - Eigen::Vector3d(0.1 + 0.01 * k, 2, 1)).norm(), 1e-9);
  }
}

TEST_F(Ros1BagTest, RegistersDepthOfAnotherFrame) {
  // Depth from 2 pixels (at 1 m) further left.
  Camera camera = SmallCamera().camera;
  const Rigid3d color_from_depth({1, 0, 0, 0}, {-2.0 / camera.fx, 0, 0});
  for (const bool says_where : {true, false}) {
    Open();
    WriteInfo();
    Write("/camera/depth/camera_info", kStart, MakeInfo(camera));
    if (says_where) {
      tf2_msgs::TFMessage message;
      message.transforms = {MakeTransform("camera_link", kOptical, kStart, {}),
                            MakeTransform("camera_link", "depth_optical",
                                          kStart, color_from_depth)};
      Write("/tf_static", kStart, message);
    }
    cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar(1000));
    depth.at<uint16_t>(10, 20) = 500;
    Write(kColor, kStart, MakeImage(ColorImage(0), "bgr8", kStart));
    Write("/camera/depth/image_raw", kStart,
          MakeImage(depth, "16UC1", kStart, "depth_optical"));
    if (!says_where) {
      ExpectRefused({"depth is seen from 'depth_optical'", "Kalibr"});
      SourceOptions options = Options();
      options.camera = SmallCamera();
      const Frame frame = OpenSource("auto", options)->Next()->read();
      EXPECT_EQ(frame.depth.at<uint16_t>(10, 20), 500) << "is registered then";
      continue;
    }
    const Frame frame = Source()->Next()->read();
    EXPECT_EQ(frame.depth.at<uint16_t>(10, 20 - 4), 500);
    EXPECT_EQ(frame.depth.at<uint16_t>(5, 20), 1000);
    EXPECT_EQ(frame.depth.at<uint16_t>(5, kWidth - 1), 0) << "not seen";
  }
}

TEST_F(Ros1BagTest, ReadsWhatTheRealSenseViewerRecords) {
  const Camera camera = SmallCamera().camera;
  const Rigid3d color_from_depth({1, 0, 0, 0}, {-2.0 / camera.fx, 0, 0});
  const std::string depth_stream = "/device_0/sensor_0/Depth_0";
  const std::string color_stream = "/device_0/sensor_1/Color_0";
  Open();
  Write(depth_stream + "/info/camera_info", kStart, MakeInfo(camera));
  Write(color_stream + "/info/camera_info", kStart, MakeInfo(camera));
  Write(depth_stream + "/tf/0", kStart, MakeMotion({}));
  Write(color_stream + "/tf/0", kStart, MakeMotion(color_from_depth));
  std_msgs::Float32 units;
  units.data = 0.00025F;
  Write("/device_0/sensor_0/option/Depth_Units/value", kStart, units);
  cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar(4000));
  Write(depth_stream + "/image/data", kStart,
        MakeImage(depth, "mono16", kStart, ""));
  Write(color_stream + "/image/data", kStart,
        MakeImage(ColorImage(0), "rgb8", kStart, ""));
  const auto source = Source();
  EXPECT_EQ(source->camera().depth_scale, 4000.0);
  const Frame frame = source->Next()->read();
  EXPECT_EQ(frame.DepthAt(20, 5), 1.0);
  EXPECT_EQ(frame.DepthAt(kWidth - 1, 5), 0.0) << "not seen";
}

TEST_F(Ros1BagTest, RefusesWhatIsNoRecording) {
  Open();
  WriteInfo();
  ExpectRefused({"a.bag: has no colour images", "/camera/rgb/camera_info"});

  Open();
  WriteInfo();
  WriteColor(0);
  ExpectRefused({"has no depth images", kColor});

  Open();
  WriteColor(0);
  WriteDepth(0);
  ExpectRefused({"does not say what camera"});

  Open();
  ExpectRefused({"has no colour images", "it has nothing"});
}

TEST_F(Ros1BagTest, RefusesWrongImages) {
  Open();
  WriteInfo();
  Write(kColor, kStart,
        MakeImage(cv::Mat(kHeight, kWidth, CV_8UC2), "yuv422", kStart));
  WriteDepth(0);
  ExpectRefused({"has no colour images that can be read"});
  SourceOptions options = Options();
  options.topics = {kColor, kDepth};
  ExpectInputError([&] { OpenSource("auto", options)->Next()->read(); },
                   {"encoding 'yuv422'", "rgb8", kColor});

  Open();
  WriteInfo();
  WriteColor(0);
  Write(kDepth, kStart,
        MakeImage(cv::Mat(kHeight / 2, kWidth / 2, CV_16UC1), "16UC1", kStart));
  ExpectRefused({kDepth, "16 x 12", "32 x 24"});

  Open();
  WriteInfo();
  WriteColor(0);
  sensor_msgs::Image cut = MakeImage(DepthImage(0), "16UC1", kStart);
  cut.data.resize(100);
  Write(kDepth, kStart, cut);
  ExpectRefused({kDepth, "holds 100 bytes, too few"});
}

TEST_F(Ros1BagTest, RefusesImagesOfOtherTimes) {
  Open();
  WriteInfo();
  WriteColor(0);
  Write(kDepth, kStart, MakeImage(DepthImage(0), "16UC1", kStart + 5));
  ExpectRefused({"none of 1 colour and 1 depth images", "5.000000 s"});
}

TEST_F(Ros1BagTest, RefusesDistortionThatItDoesNotKnow) {
  Open();
  sensor_msgs::CameraInfo info = MakeInfo(SmallCamera().camera);
  info.distortion_model = "equidistant";
  info.D = {0.1, 0.1, 0.1, 0.1};
  Write("/camera/rgb/camera_info", kStart, info);
  WriteColor(0);
  WriteDepth(0);
  ExpectRefused({"camera_info: distortion 'equidistant'", "calibration file"});
}

TEST_F(Ros1BagTest, WhatFailsOnTheWayLeavesNoFolder) {
  Open();
  WriteInfo();
  for (int k = 0; k < kFrames; ++k) {
    WriteColor(k);
    if (k < 15) WriteDepth(k);
  }
  Write(kDepth, StampOf(15),
        MakeImage(cv::Mat(3, 5, CV_16UC1), "16UC1", StampOf(15)));
  const auto source = Source();
  const std::string output = folder_ / "tum";
  ExpectInputError([&] { WriteTumSequence(source.get(), output); },
                   {"5 x 3 pixels", kDepth});
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST_F(Ros1BagTest, RefusesDamagedBags) {
  Open();
  WriteAll();
  Options();
  const std::string whole = ReadTextFile(path_);
  for (const double share : {0.0, 0.0001, 0.3, 0.9, 0.999}) {
    folder_.Write("a.bag", whole.substr(0, share * whole.size()));
    ExpectRefused({"a.bag: "});
  }
  // The library does not print by itself.
  std::string damaged = whole;
  damaged.replace(whole.size() - 40, 8, std::string(8, '\xff'));
  folder_.Write("a.bag", damaged);
  testing::internal::CaptureStderr();
  ExpectRefused({"a.bag: ", "damaged"});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");

  folder_.Write("a.bag", "no bag at all, but a text of some length");
  ExpectRefused({"a.bag: ", "ROS 1 bag"});

  // Its recorder was killed: nothing says where the index is.
  std::string unindexed = whole;
  const std::string name = "index_pos=";
  const size_t place = unindexed.find(name);
  ASSERT_NE(place, std::string::npos);
  unindexed.replace(place + name.size(), 8, std::string(8, '\0'));
  folder_.Write("a.bag", unindexed);
  ExpectRefused({"a.bag: has no index", "rosbag reindex"});
}

}  // namespace
}  // namespace rgbd_pose
