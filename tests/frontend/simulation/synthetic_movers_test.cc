#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "frontend/simulation/synthetic_dataset.h"

namespace rgbd_pose {
namespace {

SyntheticOptions NoiseFree(const std::string& path) {
  SyntheticOptions options;
  options.path = path;
  options.noise = false;
  return options;
}

double LargestChange(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

TEST(SyntheticMoversTest, APatchCoversItsShareAndMovesByItself) {
  SyntheticOptions options = NoiseFree("still");
  const Frame bare = SyntheticDataset(options).Read(0);
  for (const double share : {0.1, 0.4}) {
    options.moving_patch = share;
    const SyntheticDataset dataset(options);
    cv::Rect before;
    for (int i = 40; i < 60; ++i) {
      const Frame frame = dataset.Read(i);
      const cv::Mat covered = frame.depth != bare.depth;
      const double area = static_cast<double>(covered.total());
      EXPECT_NEAR(cv::countNonZero(covered) / area, share, 0.005);
      EXPECT_EQ(cv::countNonZero(frame.depth == frame.depth_scale),
                cv::countNonZero(covered));
      const cv::Rect now = cv::boundingRect(covered);
      if (i > 40) {
        const double step = std::hypot(now.x - before.x, now.y - before.y);
        EXPECT_GE(step, 5.0 - 1.5) << i;  // rounded to whole pixels
        EXPECT_LE(step, 8.0 + 1.5) << i;
      }
      before = now;
    }
  }
}

TEST(SyntheticMoversTest, BoxesWalkBeforeTheRoom) {
  SyntheticOptions options = NoiseFree("still");
  const Frame bare = SyntheticDataset(options).Read(0);
  options.walking_boxes = 3;
  const SyntheticDataset dataset(options);
  int most = 0;
  for (int i = 0; i < dataset.size(); i += 10) {
    const Frame frame = dataset.Read(i);
    EXPECT_EQ(cv::countNonZero(frame.depth > bare.depth), 0) << i;
    EXPECT_GT(LargestChange(frame.depth, dataset.Read(i + 1).depth), 0.0) << i;
    most = std::max(most, cv::countNonZero(frame.depth < bare.depth));
  }
  EXPECT_GT(most, 0.2 * bare.depth.total());
  // With a rolling shutter, movers are drawn at the time of each row.
  options.color_shutter.readout = 0.03;
  const Frame rolled = SyntheticDataset(options).Read(50);
  EXPECT_GT(LargestChange(rolled.color, dataset.Read(50).color), 0.0);
  EXPECT_EQ(LargestChange(rolled.depth, dataset.Read(50).depth), 0.0);
}

TEST(SyntheticMoversTest, TheMiddleIsBlack) {
  SyntheticOptions options = NoiseFree("xyz");
  options.frames = 9;
  options.black_s = 0.1;
  const SyntheticDataset dataset(options);
  for (int i = 0; i < options.frames; ++i) {
    const Frame frame = dataset.Read(i);
    EXPECT_EQ(cv::countNonZero(frame.gray) == 0, i >= 3 && i <= 5) << i;
    EXPECT_GT(cv::countNonZero(frame.depth), 0);
  }
}

}  // namespace
}  // namespace rgbd_pose
