#include "frontend/frame/repeated_images.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <tuple>

namespace rgbd_pose {
namespace {

cv::Mat Noise(int type, int seed) {
  cv::Mat image(48, 64, type);
  cv::RNG random(seed);
  random.fill(image, cv::RNG::UNIFORM, 1, 200);
  return image;
}

Frame FrameOf(const cv::Mat& gray, const cv::Mat& depth) {
  Frame frame;
  frame.gray = gray.clone();  // a driver sends a copy
  frame.depth = depth.clone();
  return frame;
}

class RepeatedImagesTest : public testing::Test {
 protected:
  const cv::Mat gray_[2] = {Noise(CV_8UC1, 1), Noise(CV_8UC1, 2)};
  const cv::Mat depth_[2] = {Noise(CV_16UC1, 3), Noise(CV_16UC1, 4)};
  RepeatedImages images_;
};

TEST_F(RepeatedImagesTest, FindsFramesOfWhichAnImageIsNotNew) {
  for (const auto& [gray, depth, is_repeated] : {std::tuple(0, 0, false),
                                                 {0, 1, true},
                                                 {0, 1, true},
                                                 {1, 0, false},
                                                 {0, 0, true},
                                                 {1, 1, false}}) {
    EXPECT_EQ(images_.IsRepeated(FrameOf(gray_[gray], depth_[depth])),
              is_repeated);
  }
  EXPECT_EQ(images_.counts().color, 2);
  EXPECT_EQ(images_.counts().depth, 2);
}

// One pixel may be all that differs between two images without noise.
TEST_F(RepeatedImagesTest, OnePixelMakesAnImageNew) {
  Frame first = FrameOf(gray_[0], depth_[0]);
  Frame second = first;
  second.gray = first.gray.clone();
  second.gray.at<uint8_t>(47, 63) ^= 1;
  second.depth = depth_[1];
  EXPECT_FALSE(images_.IsRepeated(first));
  EXPECT_FALSE(images_.IsRepeated(second));
}

TEST_F(RepeatedImagesTest, DarkImagesMayBeEqual) {
  const cv::Mat black = cv::Mat::zeros(48, 64, CV_8UC1);
  const cv::Mat none = cv::Mat::zeros(48, 64, CV_16UC1);
  for (int i = 0; i < 3; ++i) {
    Frame frame = FrameOf(black, none);
    EXPECT_FALSE(images_.IsRepeated(frame));
  }
  EXPECT_EQ(images_.counts().color, 0);
  EXPECT_EQ(images_.counts().depth, 0);
}

}  // namespace
}  // namespace rgbd_pose
