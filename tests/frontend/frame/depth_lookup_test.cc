#include "frontend/frame/depth_lookup.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbd_pose {
namespace {

constexpr double kScale = 5000.0;
constexpr double kRawStep = 1.0 / kScale;  // m, of the 16-bit image

Frame FlatFrame(double depth) {
  Frame frame;
  frame.depth =
      cv::Mat(480, 640, CV_16UC1, cv::Scalar(std::lround(depth * kScale)));
  frame.depth_scale = kScale;
  return frame;
}

void Set(Frame* frame, int column, int row, double depth) {
  frame->depth.at<uint16_t>(row, column) =
      static_cast<uint16_t>(std::lround(depth * kScale));
}

TEST(DepthLookupTest, ReadsAFlatWall) {
  const DepthSample sample = LookUpDepth(FlatFrame(2.0), 100.3, 200.7, {});
  EXPECT_NEAR(sample.depth, 2.0, kRawStep);
  EXPECT_DOUBLE_EQ(sample.sigma, 1.425e-3 * 4.0);
}

// Inverse depth is linear over the image of a plane: exact between pixels.
TEST(DepthLookupTest, ReadsASlantedWallBetweenPixels) {
  Frame frame = FlatFrame(2.0);
  for (int row = 0; row < 480; ++row) {
    for (int column = 0; column < 640; ++column) {
      Set(&frame, column, row, 1.0 / (0.5 + 1e-3 * (column - 300)));
    }
  }
  const DepthSample sample = LookUpDepth(frame, 320.4, 240.0, {});
  EXPECT_NEAR(sample.depth, 1.0 / (0.5 + 1e-3 * 20.4), kRawStep);
}

TEST(DepthLookupTest, NeverMixesTwoSurfaces) {
  Frame frame = FlatFrame(2.0);
  frame.depth.colRange(320, 640).setTo(std::lround(2.5 * kScale));
  EXPECT_EQ(LookUpDepth(frame, 319.0, 240.0, {}).depth, 0.0);
  EXPECT_EQ(LookUpDepth(frame, 320.0, 240.0, {}).depth, 0.0);
  EXPECT_NEAR(LookUpDepth(frame, 318.0, 240.0, {}).depth, 2.0, kRawStep);
  EXPECT_NEAR(LookUpDepth(frame, 321.0, 240.0, {}).depth, 2.5, kRawStep);
}

TEST(DepthLookupTest, TakesTheCentreBesideAFewHoles) {
  Frame frame = FlatFrame(2.0);
  Set(&frame, 100, 100, 2.004);
  Set(&frame, 101, 100, 0.0);
  frame.depth.at<uint16_t>(101, 101) = Frame::kNoDepth;
  EXPECT_NEAR(LookUpDepth(frame, 100.4, 100.0, {}).depth, 2.004, kRawStep);
  for (int column = 99; column <= 101; ++column) Set(&frame, column, 99, 0.0);
  EXPECT_EQ(LookUpDepth(frame, 100.4, 100.0, {}).depth, 0.0);
}

TEST(DepthLookupTest, HasNoneOnAHoleOutsideOrBeyondTheLimits) {
  Frame frame = FlatFrame(2.0);
  Set(&frame, 100, 100, 0.0);
  EXPECT_EQ(LookUpDepth(frame, 100.0, 100.0, {}).depth, 0.0);
  for (const double u : {-5.0, 0.0, 639.0, 700.0}) {
    EXPECT_EQ(LookUpDepth(frame, u, 240.0, {}).depth, 0.0) << u;
  }
  EXPECT_EQ(LookUpDepth(FlatFrame(9.0), 320, 240, {}).depth, 0.0);
  EXPECT_EQ(LookUpDepth(FlatFrame(0.2), 320, 240, {}).depth, 0.0);
}

}  // namespace
}  // namespace rgbd_pose
