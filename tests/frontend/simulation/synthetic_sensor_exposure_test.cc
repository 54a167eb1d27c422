#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/geometry/twist.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_sensor.h"

namespace rgbd_pose {
namespace {

constexpr double kFocal = 131.25;

// A smaller image with the same field of view, for speed.
Renderer RoomRenderer() {
  return Renderer(MakeScene("room", 1),
                  {160, 120, kFocal, kFocal, 79.5, 59.5, 0, 0, 0});
}

Rigid3d Handheld(double t) { return FindSyntheticPath("handheld")(t, 5.0); }

double MeanDifference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  const cv::Scalar mean = cv::mean(difference);
  return (mean[0] + mean[1] + mean[2]) / 3.0;
}

// Mean colour while the shutter is open, with more renderings than needed.
cv::Mat MeanColor(const Renderer& renderer, double opening, double closing) {
  constexpr int kRenderings = 40;
  cv::Mat sum = cv::Mat::zeros(120, 160, CV_32FC3);
  for (int i = 0; i < kRenderings; ++i) {
    const double t = opening + (closing - opening) * (i + 0.5) / kRenderings;
    cv::add(sum, renderer.Render(Handheld(t)).color, sum, cv::noArray(),
            CV_32F);
  }
  cv::Mat mean;
  sum.convertTo(mean, CV_8U, 1.0 / kRenderings);
  return mean;
}

TEST(SyntheticExposureTest, AnInstantIsARendering) {
  const Renderer renderer = RoomRenderer();
  const Rendering instant = Expose(renderer, kFocal, Handheld, 1.0, {});
  const Rendering rendering = renderer.Render(Handheld(1.0));
  EXPECT_EQ(cv::norm(instant.color, rendering.color, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(instant.depth, rendering.depth, cv::NORM_INF), 0.0);
}

TEST(SyntheticExposureTest, BlurIsTheMeanAroundTheMiddle) {
  const Renderer renderer = RoomRenderer();
  constexpr double kMiddle = 1.0;    // s; the camera is fast there
  constexpr double kShutter = 0.03;  // s
  const Rendering blurred =
      Expose(renderer, kFocal, Handheld, kMiddle, {kShutter, 1.0});
  const Rendering sharp = renderer.Render(Handheld(kMiddle));
  EXPECT_EQ(cv::norm(blurred.depth, sharp.depth, cv::NORM_INF), 0.0);

  const auto difference = [&](double opening) {
    return MeanDifference(blurred.color,
                          MeanColor(renderer, opening, opening + kShutter));
  };
  const double centred = difference(kMiddle - kShutter / 2.0);
  // Steps of 2 px leave traces of fine print: about one gray level.
  EXPECT_LT(centred, 1.5);
  EXPECT_GT(MeanDifference(blurred.color, sharp.color), 3.0 * centred);
  EXPECT_GT(difference(kMiddle), 3.0 * centred);
  EXPECT_GT(difference(kMiddle - kShutter), 3.0 * centred);
}

class ReadoutTest : public testing::TestWithParam<double> {};

TEST_P(ReadoutTest, ShowsEachBandAtItsTime) {
  const Renderer renderer = RoomRenderer();
  constexpr double kMiddle = 1.0;  // s; the camera is fast there
  const Rendering rolled =
      Expose(renderer, kFocal, Handheld, kMiddle, {0.0, 1.0, GetParam()});
  const Rendering instant = renderer.Render(Handheld(kMiddle));
  constexpr int kBands = 15;
  for (int band = 0; band < kBands; ++band) {
    const cv::Range rows(band * Renderer::kBandRows,
                         (band + 1) * Renderer::kBandRows);
    const double time = kMiddle + ((band + 0.5) / kBands - 0.5) * GetParam();
    const cv::Mat then = renderer.Render(Handheld(time)).depth.rowRange(rows);
    // A pixel or two differ at edges, where faces overlap.
    EXPECT_LE(cv::countNonZero(then != rolled.depth.rowRange(rows)), 2) << band;
    const int moved = cv::countNonZero(instant.depth.rowRange(rows) !=
                                       rolled.depth.rowRange(rows));
    if (band == kBands / 2) {
      EXPECT_LE(moved, 2);
    } else {
      EXPECT_GT(moved, 500) << band;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Readouts, ReadoutTest, testing::Values(0.03, -0.03));

// The last band of an image may be incomplete.
TEST(SyntheticExposureTest, ReadoutIsThatOfRows) {
  const Renderer renderer(MakeScene("room", 1),
                          {160, 100, kFocal, kFocal, 79.5, 49.5, 0, 0, 0});
  const Shutter shutter = {0.0, 0.03};
  const cv::Mat rolled =
      Expose(renderer, kFocal, Handheld, 1.0, {0.0, 1.0, shutter.readout})
          .depth;
  for (const int band : {0, 12}) {
    const cv::Range rows(band * Renderer::kBandRows,
                         std::min((band + 1) * Renderer::kBandRows, 100));
    const double middle = (rows.start + rows.end - 1) / 2.0;
    const Rigid3d pose = Handheld(1.0 + shutter.RowTime(middle, 100));
    const cv::Mat then = renderer.Render(pose).depth.rowRange(rows);
    EXPECT_LE(cv::countNonZero(then != rolled.rowRange(rows)), 2) << band;
  }
}

TEST(SyntheticExposureTest, AStillCameraBlursNothing) {
  const Renderer renderer = RoomRenderer();
  const auto still = [](double) { return Handheld(1.0); };
  const Rendering image = Expose(renderer, kFocal, still, 1.0, {0.03, 1.0});
  const cv::Mat sharp = renderer.Render(Handheld(1.0)).color;
  EXPECT_EQ(cv::norm(image.color, sharp, cv::NORM_INF), 0.0);
}

TEST(SyntheticExposureTest, GainSaturates) {
  const Renderer renderer = RoomRenderer();
  const cv::Mat once = renderer.Render(Handheld(0.0)).color;
  const cv::Mat twice =
      Expose(renderer, kFocal, Handheld, 0.0, {0.0, 2.0}).color;
  int saturated = 0;
  for (int v = 0; v < once.rows; ++v) {
    const uint8_t* row = once.ptr<uint8_t>(v);
    for (int i = 0; i < 3 * once.cols; ++i) {
      EXPECT_EQ(twice.ptr<uint8_t>(v)[i], std::min(2 * row[i], 255));
      saturated += row[i] > 127;
    }
  }
  EXPECT_GT(saturated, 0) << "the image is too dark to show it";
}

TEST(SyntheticExposureTest, DriftSwingsAroundOne) {
  constexpr double kTolerance = 1e-12;  // rounding
  EXPECT_EQ(DriftingGain(0.0, 1.234), 1.0);
  EXPECT_EQ(DriftingGain(0.3, 0.0), 1.0);
  EXPECT_NEAR(DriftingGain(0.3, kExposurePeriod / 4), std::exp(0.3),
              kTolerance);
  EXPECT_NEAR(DriftingGain(0.3, kExposurePeriod * 3 / 4), std::exp(-0.3),
              kTolerance);
  EXPECT_NEAR(DriftingGain(0.3, kExposurePeriod), 1.0, kTolerance);
}

}  // namespace
}  // namespace rgbd_pose
