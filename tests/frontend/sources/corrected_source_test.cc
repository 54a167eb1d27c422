#include "frontend/sources/corrected_source.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbd_pose {
namespace {

// A wall at a depth (m), everywhere.
Frame Wall(double depth) {
  Frame frame;
  frame.gray = cv::Mat::zeros(480, 640, CV_8UC1);
  frame.depth = cv::Mat(480, 640, CV_16UC1,
                        cv::Scalar(std::lround(depth * frame.depth_scale)));
  frame.depth.at<uint16_t>(10, 10) = 0;
  frame.depth.at<uint16_t>(10, 20) = Frame::kNoDepth;
  return frame;
}

TEST(CorrectedSourceTest, InverseDepthMovesByItsOffset) {
  RgbdCamera camera;
  camera.depth_errors.inverse_depth_offset = 0.01;
  const Frame frame = CorrectDepth(camera, Wall(2.0));
  EXPECT_NEAR(1.0 / frame.DepthAt(320, 240), 0.51, 1e-4);
  EXPECT_EQ(frame.DepthAt(10, 10), 0.0);
  EXPECT_EQ(frame.DepthAt(20, 10), 0.0);
}

TEST(CorrectedSourceTest, StampsMoveByTheirOffset) {
  RgbdCamera camera;
  camera.depth_errors.depth_time_offset = 0.015;
  Frame wall = Wall(2.0);
  wall.depth_delay = -0.005;
  EXPECT_NEAR(CorrectDepth(camera, wall).depth_delay, 0.01, 1e-12);
}

// Depth that is too far ahead comes back.
TEST(CorrectedSourceTest, RegistrationIsUndone) {
  RgbdCamera camera;
  camera.depth_errors.depth_from_color.translation.z() = 0.02;
  const Frame frame = CorrectDepth(camera, Wall(2.0));
  EXPECT_NEAR(frame.DepthAt(320, 240), 1.98, 1e-3);
}

TEST(CorrectedSourceTest, PlainDepthIsLeftAlone) {
  const Frame wall = Wall(2.0);
  EXPECT_EQ(CorrectDepth(RgbdCamera(), wall).depth.data, wall.depth.data);
  EXPECT_TRUE(DepthErrors().None());
}

}  // namespace
}  // namespace rgbd_pose
