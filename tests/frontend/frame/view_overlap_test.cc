#include "frontend/frame/view_overlap.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace rgbd_pose {
namespace {

constexpr int kSampleStep = 8;

// A wall 2 m away with a pattern of blobs.
class ViewOverlapTest : public testing::Test {
 protected:
  ViewOverlapTest() {
    cv::RNG random(3);
    frame_.gray.create(120, 160, CV_8UC1);
    random.fill(frame_.gray, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(frame_.gray, frame_.gray, {}, 4.0);
    cv::normalize(frame_.gray, frame_.gray, 0, 255, cv::NORM_MINMAX);
    frame_.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(10000));
  }

  ViewLikeness To(const Frame& cur, const Rigid3d& cur_from_view = {}) const {
    const ViewOverlap samples(frame_, camera_, kSampleStep, 0.3, 5.0);
    return samples.LikenessTo(cur, frame_.gray, cur.gray, cur_from_view);
  }

  const Camera camera_ = {160, 120, 131.25, 131.25, 79.5, 59.5, 0, 0, 0};
  Frame frame_;
};

TEST_F(ViewOverlapTest, AViewIsLikeItselfInAnyLight) {
  const ViewLikeness same = To(frame_);
  EXPECT_GT(same.gray, 0.95);
  EXPECT_EQ(same.depth, 1.0);
  Frame dark = frame_;
  dark.gray = frame_.gray * 0.5;
  EXPECT_GT(To(dark).gray, 0.9);
}

TEST_F(ViewOverlapTest, ACoveredLensShowsNothingOfIt) {
  Frame covered = frame_;
  covered.gray = cv::Mat(120, 160, CV_8UC1, cv::Scalar(80));
  covered.depth = cv::Mat::zeros(120, 160, CV_16UC1);
  const ViewLikeness likeness = To(covered);
  EXPECT_NEAR(likeness.gray, 0.0, 1e-9);
  EXPECT_EQ(likeness.depth, 0.0);
}

TEST_F(ViewOverlapTest, AWrongMotionShowsSomethingElse) {
  Rigid3d wrong;
  wrong.translation = Eigen::Vector3d(0.3, 0.0, 0.5);  // 20 px and more
  const ViewLikeness likeness = To(frame_, wrong);
  EXPECT_LT(likeness.gray, 0.25);
  EXPECT_EQ(likeness.depth, 0.0);
}

TEST_F(ViewOverlapTest, WhatIsNotSeenIsLikeNothing) {
  Rigid3d behind;
  behind.translation = Eigen::Vector3d(0.0, 0.0, -3.0);
  const ViewLikeness likeness = To(frame_, behind);
  EXPECT_EQ(likeness.gray, 0.0);
  EXPECT_EQ(likeness.depth, 0.0);
}

}  // namespace
}  // namespace rgbd_pose
