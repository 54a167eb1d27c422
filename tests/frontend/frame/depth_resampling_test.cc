#include "frontend/frame/depth_resampling.h"

#include <gtest/gtest.h>

#include <array>

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
  const cv::Mat start = ResampleDepth(
      depth, kLarge, kPlace * 1.0 + cv::Matx23d(0, 0, -0.3, 0, 0, 0));
  EXPECT_EQ(start.at<uint16_t>(240, 0), 0);     // at -0.6
  EXPECT_EQ(start.at<uint16_t>(240, 1), 1000);  // at -0.2
}

TEST(DepthResamplingTest, WhatDoesNotFitIsNoDepth) {
  EXPECT_EQ(EncodeDepth(65534.2F), 65534);
  EXPECT_EQ(EncodeDepth(65534.7F), 0);
  EXPECT_EQ(EncodeDepth(70000.0F), 0);
  const std::array<uint16_t, 16> row = [] {
    std::array<uint16_t, 16> depths;
    depths.fill(65000);
    return depths;
  }();
  for (const float offset : {500.0F, 534.7F, 600.0F}) {
    std::array<uint16_t, 8> moved;
    MoveEight(row.data(), row.data(), row.data(), {0.0F, 0.0F, 1.0F, offset},
              moved.data());
    for (const uint16_t depth : moved) {
      EXPECT_EQ(depth, EncodeDepth(65000.0F + offset)) << offset;
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
