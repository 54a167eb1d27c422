#include "frontend/frame/prepared_frame.h"

#include <gmock/gmock.h>

#include <future>
#include <vector>

#include "frontend/frame/image_pyramid.h"

namespace rgbd_pose {
namespace {

struct Sum {
  Sum(const PreparedFrame& frame, int factor)
      : value(factor * static_cast<int>(cv::sum(frame.gray)[0])) {
    ++made;
  }
  int value;
  static int made;
};
int Sum::made = 0;

PreparedFrame Gray(int level) {
  Frame frame;
  frame.gray = cv::Mat(32, 64, CV_8UC1, cv::Scalar(level));
  return PreparedFrame(frame);
}

TEST(PreparedFrameTest, MakesAThingOnceForEachArgumentAndFrame) {
  Sum::made = 0;
  const PreparedFrame frame = Gray(1), other = Gray(3);
  EXPECT_EQ(frame.Derived<Sum>(2).value, 2 * 32 * 64);
  EXPECT_EQ(frame.Derived<Sum>(5).value, 5 * 32 * 64);
  EXPECT_EQ(other.Derived<Sum>(2).value, 6 * 32 * 64);
  EXPECT_EQ(&frame.Derived<Sum>(2), &frame.Derived<Sum>(2));
  EXPECT_EQ(Sum::made, 3);
}

TEST(PreparedFrameTest, CopiesShareWhateverTheirVelocity) {
  const PreparedFrame frame = Gray(1);
  const Twist twist = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};
  const PreparedFrame moved = frame.WithTwist(twist);
  EXPECT_EQ(moved.twist->angular, twist.angular);
  EXPECT_FALSE(frame.twist.has_value());
  EXPECT_EQ(moved.gray.data, frame.gray.data);
  EXPECT_EQ(&moved.Derived<SmoothPyramid>(), &frame.Derived<SmoothPyramid>());
}

// The next image may have been written into the same memory.
TEST(PreparedFrameTest, AFrameThatIsPreparedAgainIsMadeAgain) {
  Frame frame = Gray(1);
  const PreparedFrame first(frame);
  EXPECT_EQ(first.Derived<Sum>(1).value, 32 * 64);
  frame.gray.setTo(2);
  EXPECT_EQ(PreparedFrame(frame).Derived<Sum>(1).value, 2 * 32 * 64);
}

TEST(PreparedFrameTest, BothPyramidsShareTheImage) {
  const PreparedFrame frame = Gray(7);
  const auto& sharp = frame.Derived<ImagePyramid>().levels;
  const auto& smooth = frame.Derived<SmoothPyramid>().levels;
  ASSERT_EQ(sharp.size(), 3u);  // for 32 rows
  ASSERT_EQ(smooth.size(), sharp.size());
  EXPECT_EQ(sharp[0].data, frame.gray.data);
  EXPECT_EQ(smooth[0].data, frame.gray.data);
  EXPECT_NE(smooth[1].data, sharp[1].data);
}

TEST(PreparedFrameTest, ThreadsMayAskAtOnce) {
  const PreparedFrame frame = Gray(1);
  std::vector<std::future<const SmoothPyramid*>> asked;
  for (int i = 0; i < 8; ++i) {
    asked.push_back(std::async(std::launch::async, [frame] {
      return &frame.Derived<SmoothPyramid>();
    }));
  }
  for (auto& pyramid : asked) {
    EXPECT_EQ(pyramid.get(), &frame.Derived<SmoothPyramid>());
  }
}

}  // namespace
}  // namespace rgbd_pose
