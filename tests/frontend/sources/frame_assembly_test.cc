#include "frontend/sources/frame_assembly.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "core/geometry/camera.h"
#include "frontend/files/image_file.h"
#include "frontend/sources/masks.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

// A wall with the same depth (m) at all pixels.
Frame Wall(double depth) {
  Frame frame;
  frame.gray = cv::Mat::zeros(480, 640, CV_8UC1);
  frame.depth = cv::Mat(480, 640, CV_16UC1,
                        cv::Scalar(std::lround(depth * frame.depth_scale)));
  frame.depth.at<uint16_t>(10, 10) = 0;
  frame.depth.at<uint16_t>(10, 20) = Frame::kNoDepth;
  return frame;
}

TEST(CorrectDepthTest, InverseDepthMovesByItsOffset) {
  RgbdCamera camera;
  camera.depth_correction.inverse_depth_offset = 0.01;
  const Frame frame = CorrectDepth(camera, Wall(2.0));
  EXPECT_NEAR(1.0 / frame.DepthAt(320, 240), 0.51, 1e-4);
  EXPECT_EQ(frame.DepthAt(10, 10), 0.0);
  EXPECT_EQ(frame.DepthAt(20, 10), 0.0);
}

// Time stamps are unchanged; shutters are taken from the camera only.
TEST(CorrectDepthTest, FramesHaveTheShuttersOfTheCamera) {
  RgbdCamera camera;
  camera.color_shutter = {-0.007, 0.028};
  camera.depth_shutter = {0.015, 0.0};
  Frame wall = Wall(2.0);
  wall.depth_delay = -0.005;
  wall.color_shutter.offset = 0.5;
  const Frame frame = CorrectDepth(camera, wall);
  EXPECT_EQ(frame.depth_delay, -0.005);
  EXPECT_EQ(frame.color_shutter.offset, -0.007);
  EXPECT_EQ(frame.color_shutter.readout, 0.028);
  EXPECT_EQ(frame.depth_shutter.offset, 0.015);
  EXPECT_EQ(frame.depth_shutter.readout, 0.0);
  EXPECT_NEAR(frame.DepthShutter().offset, 0.01, 1e-12);
  EXPECT_EQ(frame.depth.data, wall.depth.data);
}

// A depth offset of the registration is removed.
TEST(CorrectDepthTest, RegistrationIsUndone) {
  RgbdCamera camera;
  camera.depth_correction.depth_from_color.translation.z() = 0.02;
  const Frame frame = CorrectDepth(camera, Wall(2.0));
  EXPECT_NEAR(frame.DepthAt(320, 240), 1.98, 1e-3);
}

TEST(CorrectDepthTest, PlainDepthIsLeftAlone) {
  const Frame wall = Wall(2.0);
  EXPECT_EQ(CorrectDepth(RgbdCamera(), wall).depth.data, wall.depth.data);
}

// mask/NAME.png, in the folder of the images or beside it.
class MaskTest : public testing::TestWithParam<const char*> {
 protected:
  MaskTest() {
    WritePngFile(color_, cv::Mat(480, 640, CV_8UC1, cv::Scalar(90)));
    WritePngFile(depth_, Wall(2.0).depth);
  }

  Frame Read() {
    CameraSetup setup;
    return FrameAssembly(setup, /*keep_color=*/false)
        .Read(Frame(), color_, depth_);
  }
  void WriteMask(const cv::Mat& mask) {
    const std::string path = folder_ / GetParam();
    std::filesystem::create_directories(
        std::filesystem::path(path).parent_path());
    WritePngFile(path, mask);
  }

  const TempFolder folder_;
  const std::string color_ = folder_.Write("seq/rgb/1.5.png", "");
  const std::string depth_ = folder_.Write("seq/depth/1.6.png", "");
};

TEST_P(MaskTest, NothingIsMeasuredWhereTheMaskIsZero) {
  EXPECT_NEAR(Read().DepthAt(100, 100), 2.0, 1e-3);
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(1));
  mask(cv::Rect(100, 100, 50, 40)) = 0;
  WriteMask(mask);
  const Frame frame = Read();
  EXPECT_EQ(frame.DepthAt(100, 100), 0.0);
  EXPECT_EQ(frame.DepthAt(149, 139), 0.0);
  EXPECT_NEAR(frame.DepthAt(150, 100), 2.0, 1e-3);
  EXPECT_NEAR(frame.DepthAt(100, 140), 2.0, 1e-3);
}

TEST_P(MaskTest, IsAsLargeAsTheImage) {
  WriteMask(cv::Mat(240, 320, CV_8UC1, cv::Scalar(1)));
  ExpectInputError([this] { Read(); }, {"mask/1.5.png: is 320 x 240"});
}

TEST_P(MaskTest, AFolderThatFitsNoImageIsMentioned) {
  EXPECT_EQ(MaskRemark({color_}), "");
  const std::filesystem::path mask = folder_ / GetParam();
  std::filesystem::create_directories(mask.parent_path());
  const std::string remark = mask.parent_path().string() +
                             ": has no mask of a colour image, such as 1.5.png";
  EXPECT_EQ(MaskRemark({color_}).substr(0, remark.size()), remark);
  WriteMask(cv::Mat(480, 640, CV_8UC1, cv::Scalar(1)));
  EXPECT_EQ(MaskRemark({folder_ / "seq/rgb/1.4.png", color_}), "");
}

INSTANTIATE_TEST_SUITE_P(Places, MaskTest,
                         testing::Values("seq/mask/1.5.png",
                                         "seq/rgb/mask/1.5.png"));

}  // namespace
}  // namespace rgbd_pose
