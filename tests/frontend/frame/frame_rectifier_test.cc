// Compares rectified rolling-shutter images with global-shutter renderings.

#include "frontend/frame/frame_rectifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/util/quantile.h"
#include "tests/support/rolling_frame.h"

namespace rgbd_pose {
namespace {

constexpr int kIndex = 30;

Frame Seen(const Shutter& color, const Shutter& depth) {
  return HandheldFrame(kIndex, color, depth);
}

// Only pixels away from the border, which are in view in both images.
constexpr int kBorder = 20;

std::vector<double> GrayDifferences(const cv::Mat& a, const cv::Mat& b) {
  std::vector<double> errors;
  for (int v = kBorder; v < a.rows - kBorder; ++v) {
    for (int k = kBorder * a.channels(); k < (a.cols - kBorder) * a.channels();
         ++k) {
      errors.push_back(std::abs(a.ptr<uint8_t>(v)[k] - b.ptr<uint8_t>(v)[k]));
    }
  }
  return errors;
}

// Relative differences; 1 if one of the depths is unknown.
std::vector<double> DepthDifferences(const Frame& a, const Frame& b) {
  std::vector<double> errors;
  for (int v = kBorder; v < a.depth.rows - kBorder; ++v) {
    for (int u = kBorder; u < a.depth.cols - kBorder; ++u) {
      const double z = a.DepthAt(u, v), expected = b.DepthAt(u, v);
      errors.push_back(z > 0.0 && expected > 0.0 ? std::abs(z / expected - 1.0)
                                                 : 1.0);
    }
  }
  return errors;
}

void ExpectLike(const Frame& rectified, const Frame& expected,
                const Frame& rolling) {
  EXPECT_TRUE(rectified.IsOneMoment());
  EXPECT_EQ(rectified.timestamp, rolling.timestamp);
  for (const cv::Mat Frame::*image : {&Frame::gray, &Frame::color}) {
    const std::vector<double> errors =
        GrayDifferences(rectified.*image, expected.*image);
    const std::vector<double> before =
        GrayDifferences(rolling.*image, expected.*image);
    // Interpolation, and the change of velocity within the readout.
    EXPECT_LE(Median(errors), 2.0);
    EXPECT_LT(Quantile(errors, 0.9), 14.0);
    EXPECT_GT(Quantile(before, 0.9), 4.0 * Quantile(errors, 0.9));
  }
  const std::vector<double> errors = DepthDifferences(rectified, expected);
  EXPECT_LT(Median(errors), 0.001);
  EXPECT_LT(Quantile(errors, 0.9), 0.003);  // except at edges
  EXPECT_GT(Quantile(DepthDifferences(rolling, expected), 0.9), 0.015);
}

TEST(FrameRectifierTest, MakesWhatAGlobalShutterSees) {
  const Frame expected = Seen({}, {});
  FrameRectifier rectifier(HandheldOptions().camera.camera);
  for (const double sign : {1.0, -1.0}) {
    const Frame rolling = Seen({-0.0075, sign * 0.028}, {-0.018, sign * 0.028});
    const Frame rectified = rectifier.Rectify(rolling);
    ExpectLike(rectified, expected, rolling);
    // The measured images are not overwritten.
    EXPECT_NE(rectified.gray.data, rolling.gray.data);
    EXPECT_NE(rectified.depth.data, rolling.depth.data);
    EXPECT_NE(rectified.color.data, rolling.color.data);
  }
}

// Rectifies to 4 ms after the time stamp.
TEST(FrameRectifierTest, MakesWhatIsSeenFromAPlaceNearby) {
  constexpr double kLater = 0.004;
  Frame expected = Seen({kLater, 0.0}, {kLater, 0.0});
  const Frame rolling = Seen({-0.0075, 0.028}, {-0.018, 0.028});
  FrameRectifier rectifier(HandheldOptions().camera.camera);
  const Frame rectified =
      rectifier.Rectify(rolling, rolling.twist->MotionDuring(kLater));
  ExpectLike(rectified, expected, rolling);
}

// A turn that reaches 300 degrees/s within a tenth of a second: this frame is
// taken in the middle of that.
TEST(FrameRectifierTest, KnowsHowATurnStarts) {
  constexpr int kStart = 36;
  const char* const kPath = "whip_pan";
  const Frame expected = HandheldFrame(kStart, {}, {}, kPath);
  FrameRectifier rectifier(HandheldOptions().camera.camera);
  for (const double sign : {1.0, -1.0}) {
    const Frame rolling = HandheldFrame(kStart, {-0.0075, sign * 0.028},
                                        {-0.018, sign * 0.028}, kPath);
    const Frame rectified = rectifier.Rectify(rolling);
    ExpectLike(rectified, expected, rolling);
    // At the mean velocity of the frame, 8 to 15 and 0.02.
    EXPECT_LT(Quantile(GrayDifferences(rectified.gray, expected.gray), 0.9),
              6.0);
    EXPECT_LT(Quantile(DepthDifferences(rectified, expected), 0.9), 0.002);
  }
}

TEST(FrameRectifierTest, SharesWhatNeedsNothing) {
  FrameRectifier rectifier(HandheldOptions().camera.camera);
  Frame unknown = Seen({-0.0075, 0.028}, {-0.018, 0.028});
  unknown.twist.reset();
  for (const Frame& frame : {Seen({}, {}), unknown}) {
    const Frame same = rectifier.Rectify(frame);
    EXPECT_EQ(same.gray.data, frame.gray.data);
    EXPECT_EQ(same.depth.data, frame.depth.data);
    EXPECT_EQ(same.color.data, frame.color.data);
    EXPECT_EQ(same.IsOneMoment(), frame.IsOneMoment());
  }
}

TEST(FrameRectifierTest, NeedsNoColour) {
  FrameRectifier rectifier(HandheldOptions().camera.camera);
  Frame frame = Seen({-0.0075, 0.028}, {-0.018, 0.028});
  const Frame with = rectifier.Rectify(frame);
  frame.color.release();
  const Frame without = rectifier.Rectify(frame);
  EXPECT_TRUE(without.color.empty());
  EXPECT_EQ(cv::norm(with.gray, without.gray, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace rgbd_pose
