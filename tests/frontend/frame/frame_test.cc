#include "frontend/frame/frame.h"

#include <gtest/gtest.h>

#include <limits>

namespace rgbd_pose {
namespace {

TEST(FrameTest, SmallAndSenselessDelaysOfDepthDoNotCount) {
  Frame frame;
  frame.depth_shutter = {0.004, 0.02};
  for (const double delay :
       {0.0, 5e-5, -5e-5, 3.0, -0.1, std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN()}) {
    frame.depth_delay = delay;
    EXPECT_EQ(frame.DepthShutter().offset, 0.004) << delay;
    EXPECT_EQ(frame.DepthShutter().readout, 0.02) << delay;
  }
  for (const double delay : {0.015, -0.015}) {
    frame.depth_delay = delay;
    EXPECT_EQ(frame.DepthShutter().offset, 0.004 + delay);
  }
}

TEST(FrameTest, IsOfOneMomentIfNothingIsExposedAtAnotherTime) {
  Frame frame;
  EXPECT_TRUE(frame.IsOneMoment());
  frame.depth_delay = 5e-5;
  EXPECT_TRUE(frame.IsOneMoment());
  frame.depth_delay = -0.01;
  EXPECT_FALSE(frame.IsOneMoment());
  frame = Frame();
  frame.color_shutter.readout = -0.01;
  EXPECT_FALSE(frame.IsOneMoment());
  frame = Frame();
  frame.depth_shutter.offset = 0.01;
  EXPECT_FALSE(frame.IsOneMoment());
}

// Without a velocity, shutters cannot be compensated.
TEST(FrameTest, TimingTakesAVelocity) {
  Frame frame;
  frame.color_shutter = {0.001, 0.02};
  frame.depth_delay = 0.01;
  EXPECT_TRUE(frame.Timing().IsOneMoment());
  Twist twist;
  twist.angular.x() = 0.5;
  const FrameTiming with = frame.Timing(twist);
  EXPECT_EQ(with.color.readout, 0.02);
  EXPECT_EQ(with.depth.offset, 0.01);
  EXPECT_EQ(with.twist.angular.x(), 0.5);
  frame.twist = twist;
  EXPECT_EQ(frame.Timing().twist.angular.x(), 0.5);
  EXPECT_EQ(frame.Timing().color.offset, 0.001);
}

}  // namespace
}  // namespace rgbd_pose
