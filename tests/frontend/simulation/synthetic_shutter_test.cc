// Depth delays and shutters of synthetic sequences.

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <string>

#include "core/geometry/camera.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_sensor.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

SyntheticOptions WithoutNoise(const std::string& path) {
  SyntheticOptions options;
  options.path = path;
  options.noise = false;
  return options;
}

double MaxDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
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
  const auto expect = [](const Shutter& shutter, double offset,
                         double readout) {
    EXPECT_EQ(shutter.offset, offset);
    EXPECT_EQ(shutter.readout, readout);
  };
  expect(rolling.camera().color_shutter, 0.001, 0.002);
  expect(rolled.color_shutter, 0.001, 0.002);
  expect(rolling.camera().depth_shutter, 0.003, 0.004);
  expect(rolled.depth_shutter, 0.003, 0.004);
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
