#include "frontend/frame/depth_resampling.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

// Pixels of the result are 0.4 pixels of the depth image wide.
const cv::Size kLarge(640, 480);
const cv::Matx23d kPlace(0.4, 0.0, -0.3, 0.0, 0.4, -0.3);

TEST(DepthResamplingTest, AnEdgeIsNotSmeared) {
  cv::Mat depth(192, 256, CV_16UC1, cv::Scalar(1000));
  depth.colRange(100, depth.cols) = 3000;
  const cv::Mat large = ResampleDepth(depth, kLarge, kPlace);
  EXPECT_EQ(cv::countNonZero(large.colRange(0, 250) != 1000), 0);
  EXPECT_EQ(cv::countNonZero(large.colRange(250, 640) != 3000), 0);
}

TEST(DepthResamplingTest, ASlopeIsInterpolated) {
  cv::Mat depth(192, 256, CV_16UC1);
  for (int u = 0; u < depth.cols; ++u) depth.col(u) = 2000 + 10 * u;
  const cv::Mat large = ResampleDepth(depth, kLarge, kPlace);
  for (int u = 2; u < 638; ++u) {
    EXPECT_NEAR(large.at<uint16_t>(240, u), 2000 + 10 * (0.4 * u - 0.3), 1.0);
  }
}

TEST(DepthResamplingTest, NoDepthStaysNone) {
  cv::Mat depth(192, 256, CV_16UC1, cv::Scalar(1000));
  depth.colRange(40, 60) = 0;
  const cv::Mat large = ResampleDepth(depth, kLarge, kPlace);
  EXPECT_EQ(cv::countNonZero(large.colRange(100, 150)), 0);
  EXPECT_EQ(cv::countNonZero(large.colRange(0, 100) != 1000), 0);
  // Beyond the border of the depth image.
  const cv::Mat moved =
      ResampleDepth(depth, kLarge, kPlace + cv::Matx23d(0, 0, 40, 0, 0, 0));
  EXPECT_EQ(cv::countNonZero(moved.colRange(542, 640)), 0);
}

}  // namespace
}  // namespace rgbd_pose
