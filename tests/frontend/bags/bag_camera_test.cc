#include <std_msgs/Float32.h>

#include <tuple>

#include "frontend/bags/bag_topics.h"
#include "tests/frontend/bags/ros1_bag_fixture.h"

namespace rgbd_pose {
namespace {

TEST_F(Ros1BagTest, RegistersDepthOfAnotherFrame) {
  // The depth camera is further left by 2 pixels (at 1 m).
  Camera camera = SmallCamera().camera;
  const Rigid3d color_from_depth({1, 0, 0, 0}, {-2.0 / camera.fx, 0, 0});
  for (const bool says_where : {true, false}) {
    Begin();
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
      ExpectRefused({"no fixed transform from 'depth_optical'", "Kalibr"});
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

// As the driver of an Azure Kinect names it.
TEST_F(Ros1BagTest, DepthOfATopicThatIsCalledRegisteredStaysAsItIs) {
  Begin();
  cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar(1000));
  depth.at<uint16_t>(10, 20) = 500;
  Write(kColor, kStart, MakeImage(ColorImage(0), "bgr8", kStart));
  Write("/Depth_To_RGB/image_raw", kStart,
        MakeImage(depth, "16UC1", kStart, "depth_optical"));
  EXPECT_EQ(Source()->Next()->read().depth.at<uint16_t>(10, 20), 500);
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

// Distortion models as an Azure Kinect and RealSense fisheyes report them.
TEST_F(Ros1BagTest, TakesLensesOfEveryModel) {
  const std::vector<double> eight = {0.4, -2.5, 1e-3, -3e-4,
                                     1.5, 0.3,  -2.3, 1.4};
  const std::vector<double> four = {-0.008, 0.045, -0.042, 0.008};
  std::vector<double> five = four;
  five.push_back(0.0);
  const auto write_lens = [this](const std::string& model,
                                 const std::vector<double>& coefficients) {
    Open();
    sensor_msgs::CameraInfo info = MakeInfo(SmallCamera().camera);
    info.distortion_model = model;
    info.D = coefficients;
    Write("/camera/rgb/camera_info", kStart, info);
    WriteFrames(1);
  };
  for (const auto& [model, given, expected] :
       {std::tuple("rational_polynomial", eight, eight),
        std::tuple("equidistant", four, four),
        std::tuple("Kannala Brandt4", five, four)}) {
    write_lens(model, given);
    const Camera camera = Source()->camera().camera;
    EXPECT_EQ(camera.Distortion(), expected) << model;
    EXPECT_EQ(camera.lens_model == LensModel::kEquidistant, expected == four)
        << model;
  }
  write_lens("omnidirectional", four);
  ExpectRefused(
      {"camera_info: distortion 'omnidirectional'", "calibration file"});
}

// A driver that sends a part of the image, with binning of two by two pixels.
TEST_F(Ros1BagTest, PartsAndBinsOfTheImageHaveTheirCamera) {
  Open();
  const Camera small = SmallCamera().camera;
  sensor_msgs::CameraInfo info = MakeInfo(small);
  info.width = 4 * kWidth;
  info.height = 3 * kHeight;
  info.K[0] = info.K[4] = 2.0 * small.fx;
  info.K[2] = 2.0 * small.cx + 0.5 + 10.0;
  info.K[5] = 2.0 * small.cy + 0.5 + 20.0;
  info.binning_x = info.binning_y = 2;
  info.roi.x_offset = 10;
  info.roi.y_offset = 20;
  info.roi.width = 2 * kWidth;
  info.roi.height = 2 * kHeight;
  Write("/camera/rgb/camera_info", kStart, info);
  WriteFrames(1);
  const auto source = Source();
  const Camera camera = source->camera().camera;
  EXPECT_EQ(camera.width, kWidth);
  EXPECT_EQ(camera.height, kHeight);
  EXPECT_DOUBLE_EQ(camera.fx, small.fx);
  EXPECT_DOUBLE_EQ(camera.cx, small.cx);
  EXPECT_DOUBLE_EQ(camera.cy, small.cy);
  EXPECT_FALSE(source->Next()->read().gray.empty()) << "images fit it";
}

}  // namespace
}  // namespace rgbd_pose
