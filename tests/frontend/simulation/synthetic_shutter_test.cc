// Depth delays and shutters of synthetic sequences.

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/geometry/camera.h"
#include "core/geometry/twist.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_sensor.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

SyntheticOptions WithoutNoise(const std::string& path) {
  SyntheticOptions options;
  options.path = path;
  options.noise = false;
  return options;
}

double MaxDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

TEST(SyntheticShutterTest, DelayedDepthIsThatOfAnotherTime) {
  SyntheticOptions options = WithoutNoise("handheld");
  const Frame same_time = SyntheticDataset(options).Read(30);
  options.rate_hz = 100.0;
  const SyntheticDataset finer(options);  // the same path, every 10 ms
  options.rate_hz = 30.0;
  for (const double delay : {0.01, -0.01}) {
    options.depth_delay_s = delay;
    const SyntheticDataset dataset(options);
    const Frame frame = dataset.Read(30);
    EXPECT_EQ(frame.timestamp, same_time.timestamp);
    EXPECT_EQ(frame.depth_delay, delay);
    EXPECT_EQ(MaxDifference(frame.color, same_time.color), 0.0);
    EXPECT_GT(MaxDifference(frame.depth, same_time.depth), 1000.0);
    const Frame then = finer.Read(delay > 0.0 ? 101 : 99);
    EXPECT_LE(MaxDifference(frame.depth, then.depth), 1.0);  // time is rounded
  }
}

// Rows of both images, each rendered at the time given by stamp and shutter.
TEST(SyntheticShutterTest, RowsAreExposedAtTheirOwnTimes) {
  SyntheticOptions options = WithoutNoise("handheld");
  options.camera.camera = {160, 120, 131.25, 131.25, 79.5, 59.5, 0, 0, 0};
  options.depth_delay_s = 0.003;
  options.color_shutter = {0.006, 0.02};
  options.depth_shutter = {-0.012, -0.016};
  const SyntheticDataset dataset(options);
  constexpr int kIndex = 30;
  const Frame frame = dataset.Read(kIndex);
  EXPECT_EQ(frame.depth_delay, 0.003);

  const double stamp = kIndex / options.rate_hz;  // relative to the first frame
  const Renderer renderer(MakeScene(options.scene, options.seed),
                          options.camera.camera);
  const SyntheticPath path = FindSyntheticPath("handheld");
  const auto seen_at = [&](double time) {
    return renderer.Render(path(time, 5.0));
  };
  constexpr int kRows = Renderer::kBandRows;
  for (int first = 0; first < 120; first += kRows) {
    const double middle = first + (kRows - 1) / 2.0;
    const Rendering color =
        seen_at(stamp + options.color_shutter.RowTime(middle, 120));
    // The lens blurs over two rows.
    const cv::Range inner(first + 2, first + kRows - 2);
    cv::Mat difference;
    cv::absdiff(frame.color.rowRange(inner), color.color.rowRange(inner),
                difference);
    EXPECT_LT(cv::mean(difference)[1], 0.1) << first;
    const Rendering depth =
        seen_at(stamp + 0.003 + options.depth_shutter.RowTime(middle, 120));
    const cv::Range rows(first, first + kRows);
    const cv::Mat raw = EncodeDepth(depth.depth, frame.depth_scale);
    EXPECT_LE(
        cv::countNonZero(raw.rowRange(rows) != frame.depth.rowRange(rows)), 2)
        << first;
  }
}

// Points seen by a rolling shutter, moved to the time stamp with the camera's
// velocity, match the image rendered at the time stamp.
TEST(SyntheticShutterTest, RolledRowsAgreeThroughTheTwist) {
  SyntheticOptions options = WithoutNoise("pan_tilt");
  const SyntheticDataset plain(options);
  constexpr int kIndex = 12;  // 38 degrees/s
  const Frame at_stamp = plain.Read(kIndex);
  const Twist twist = TwistOf(
      plain.WorldFromCam(kIndex + 1).Inverse() * plain.WorldFromCam(kIndex - 1),
      2.0 / options.rate_hz);
  ASSERT_GT(twist.angular.norm(), 0.4);
  const Camera& camera = options.camera.camera;
  for (const double sign : {1.0, -1.0}) {
    options.color_shutter = {sign * 0.008, sign * 0.028};
    options.depth_shutter = options.color_shutter;
    const SyntheticDataset dataset(options);
    EXPECT_EQ(dataset.WorldFromCam(kIndex).translation,
              plain.WorldFromCam(kIndex).translation);
    const Frame rolled = dataset.Read(kIndex);
    int seen = 0;
    double difference = 0.0;
    double uncorrected = 0.0;
    for (int v = 3; v < camera.height; v += 8) {
      for (int u = 4; u < camera.width; u += 9) {
        const Vector3d point = camera.Unproject({u, v}, rolled.DepthAt(u, v));
        const double time = rolled.color_shutter.RowTime(v, camera.height);
        const Vector2d pixel = camera.Project(twist.MovedPoint(point, -time));
        if (!camera.Contains(pixel, 1.0)) continue;
        ++seen;
        cv::Mat patch;
        cv::getRectSubPix(
            at_stamp.gray, {1, 1},
            {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())},
            patch);
        const int gray = rolled.gray.at<uint8_t>(v, u);
        difference += std::abs(patch.at<uint8_t>(0) - gray);
        uncorrected += std::abs(at_stamp.gray.at<uint8_t>(v, u) - gray);
      }
    }
    ASSERT_GT(seen, 3000);
    EXPECT_LT(difference / seen, 4.0) << sign;  // interpolation, bands of rows
    EXPECT_GT(uncorrected, 2.0 * difference) << sign;
  }
}

TEST(SyntheticShutterTest, EachImageHasItsOwnShutter) {
  SyntheticOptions options = WithoutNoise("handheld");
  const Frame plain = SyntheticDataset(options).Read(30);
  for (const Shutter& shutter : {Shutter{0.01, 0.0}, Shutter{0.0, 0.02}}) {
    options.color_shutter = shutter;
    options.depth_shutter = {};
    const Frame color = SyntheticDataset(options).Read(30);
    EXPECT_GT(MaxDifference(color.color, plain.color), 0.0);
    EXPECT_EQ(MaxDifference(color.depth, plain.depth), 0.0);
    options.color_shutter = {};
    options.depth_shutter = shutter;
    const Frame depth = SyntheticDataset(options).Read(30);
    EXPECT_EQ(MaxDifference(depth.color, plain.color), 0.0);
    EXPECT_GT(MaxDifference(depth.depth, plain.depth), 0.0);
  }
}

// The shutters come from the options, not from the given camera.
TEST(SyntheticShutterTest, TheCameraSaysTheShuttersSimulated) {
  SyntheticOptions options = WithoutNoise("handheld");
  options.camera = *CameraPreset("tum_fr1");
  ASSERT_FALSE(options.camera.color_shutter.IsGlobal());
  const SyntheticDataset plain(options);
  EXPECT_TRUE(plain.camera().color_shutter.IsGlobal());
  EXPECT_TRUE(plain.camera().depth_shutter.IsGlobal());
  const Frame frame = plain.Read(30);
  EXPECT_TRUE(frame.IsOneMoment());
  options.camera.color_shutter = {};
  options.camera.depth_shutter = {};
  const Frame same = SyntheticDataset(options).Read(30);
  EXPECT_EQ(MaxDifference(frame.color, same.color), 0.0);
  EXPECT_EQ(MaxDifference(frame.depth, same.depth), 0.0);

  options.color_shutter = {0.001, 0.002};
  options.depth_shutter = {0.003, 0.004};
  const SyntheticDataset rolling(options);
  const Frame rolled = rolling.Read(0);
  for (const Shutter& color :
       {rolling.camera().color_shutter, rolled.color_shutter}) {
    EXPECT_EQ(color.offset, 0.001);
    EXPECT_EQ(color.readout, 0.002);
  }
  for (const Shutter& depth :
       {rolling.camera().depth_shutter, rolled.depth_shutter}) {
    EXPECT_EQ(depth.offset, 0.003);
    EXPECT_EQ(depth.readout, 0.004);
  }
}

TEST(SyntheticShutterTest, ShuttersAreNoSlowerThanFrames) {
  const auto options_with = [](const ShutterParameter& parameter,
                               double value) {
    RgbdCamera camera;
    camera.*parameter.image.*parameter.value = value;
    SyntheticOptions options;
    options.color_shutter = camera.color_shutter;
    options.depth_shutter = camera.depth_shutter;
    return options;
  };
  for (const ShutterParameter& parameter : kShutterParameters) {
    const std::string name = parameter.name;
    for (const double bad : {-0.034, 0.034, std::nan("")}) {
      ExpectInputError(
          [&] { SyntheticDataset{options_with(parameter, bad)}; },
          {name + " of a synthetic sequence must be at most 0.0333",
           "the time from frame to frame"});
    }
    for (const double good : {-0.033, 0.033}) {
      EXPECT_NO_THROW(SyntheticDataset{options_with(parameter, good)}) << name;
    }
    // Camera files must be able to store the values.
    SyntheticOptions slow = options_with(parameter, 0.51);
    slow.rate_hz = 1.0;
    ExpectInputError([&] { SyntheticDataset{slow}; },
                     {name, "as in camera files"});
  }
}

}  // namespace
}  // namespace rgbd_pose
