#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/frame/depth_lookup.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// A third of the pixels have no depth; the others are around the median.
Frame FrameWithMedian(uint16_t raw, double depth_scale) {
  Frame frame;
  frame.index = 12;
  frame.depth_scale = depth_scale;
  frame.depth = cv::Mat(6, 5, CV_16UC1, cv::Scalar(raw));
  frame.depth.row(0).setTo(0);
  frame.depth.row(1).setTo(Frame::kNoDepth);
  frame.depth.row(2).setTo(raw - 1);
  frame.depth.row(3).setTo(raw + 1);
  return frame;
}

TEST(DepthScaleTest, PlausibleDepthGivesNoWarning) {
  EXPECT_THAT(DepthScaleWarning(FrameWithMedian(10000, 5000)), IsEmpty());
  EXPECT_THAT(DepthScaleWarning(FrameWithMedian(1600, 5000)), IsEmpty());
  EXPECT_THAT(DepthScaleWarning(FrameWithMedian(20000, 1000)), IsEmpty());
}

TEST(DepthScaleTest, WarnsBelowAndAboveWhatIsPlausible) {
  const std::string near = DepthScaleWarning(FrameWithMedian(500, 5000));
  EXPECT_THAT(near, HasSubstr("frame 12"));
  EXPECT_THAT(near, HasSubstr("0.1 m"));
  EXPECT_THAT(near, HasSubstr("check the depth scale"));
  // Millimetres of a scene 1.4 m away, all of them too near to be used.
  EXPECT_THAT(DepthScaleWarning(FrameWithMedian(1400, 5000)),
              HasSubstr("0.28 m"));
  const std::string far = DepthScaleWarning(FrameWithMedian(25000, 1000));
  EXPECT_THAT(far, HasSubstr("25 m"));
  EXPECT_THAT(far, HasSubstr("1000 raw units"));
}

TEST(DepthScaleTest, AFrameWithoutDepthGivesNoWarning) {
  Frame frame = FrameWithMedian(10000, 5000);
  frame.depth.setTo(Frame::kNoDepth);
  EXPECT_THAT(DepthScaleWarning(frame), IsEmpty());
}

}  // namespace
}  // namespace rgbd_pose
