#include "frontend/simulation/synthetic_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/geometry/twist.h"
#include "frontend/simulation/synthetic_hash.h"
#include "frontend/simulation/synthetic_path.h"

namespace rgbd_pose {
namespace {

constexpr double kSensorFocal = 525.0;
constexpr uint64_t kKey = 17;

struct Moments {
  double mean = 0.0;
  double sigma = 0.0;
};

Moments MomentsOf(const cv::Mat& image) {
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(image, mean, sigma);
  return {mean[0], sigma[0]};
}

TEST(SyntheticHashTest, GaussianHasItsMoments) {
  constexpr int kDraws = 200000;
  double sum = 0.0;
  double sum2 = 0.0;
  double sum4 = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = GaussianFromBits(HashCounter(i));
    sum += x;
    sum2 += x * x;
    sum4 += x * x * x * x;
  }
  // Five standard errors: 1, sqrt(2) and sqrt(96) over sqrt(draws).
  const double kStandardError = 5.0 / std::sqrt(kDraws);
  EXPECT_NEAR(sum / kDraws, 0.0, kStandardError);
  EXPECT_NEAR(sum2 / kDraws, 1.0, 1.5 * kStandardError);
  EXPECT_NEAR(sum4 / kDraws, 2.85, 10.0 * kStandardError);
}

TEST(SyntheticSensorTest, DepthNoiseOfAWallFollowsTheModel) {
  for (const double z : {0.7, 1.5, 3.0, 5.0}) {
    const cv::Mat wall(300, 400, CV_32FC1, cv::Scalar(z));
    const Moments measured = MomentsOf(MeasureDepth(wall, kSensorFocal, kKey));
    // Khoshelham & Elberink's noise, plus the variance of rounding to a step of
    // twice that sigma: 1/12 of the squared step.
    const double noise = 1.425e-3 * z * z;
    const double step = 2.85e-3 * z * z;
    const double sigma = std::sqrt(noise * noise + step * step / 12.0);
    // With a step of 2 sigma, the spread is a few percent off this sum.
    EXPECT_NEAR(measured.sigma, sigma, 0.05 * sigma) << z;
    // The mean may be shifted as well, by less than a twentieth of a step.
    EXPECT_NEAR(measured.mean, z, 0.05 * step) << z;
  }
}

TEST(SyntheticSensorTest, DepthComesInEighthsOfADisparityPixel) {
  const cv::Mat wall(50, 50, CV_32FC1, cv::Scalar(2.0));
  const cv::Mat depth = MeasureDepth(wall, kSensorFocal, kKey);
  for (int v = 0; v < depth.rows; ++v) {
    const double eighths = 1.0 / (kInverseDepthStep * depth.at<float>(v, v));
    EXPECT_NEAR(eighths, std::round(eighths), 1e-3);  // single precision
  }
}

TEST(SyntheticSensorTest, NoDepthOutOfRange) {
  for (const double z : {0.0, 0.49, 8.01}) {
    const cv::Mat wall(20, 20, CV_32FC1, cv::Scalar(z));
    EXPECT_EQ(cv::countNonZero(MeasureDepth(wall, kSensorFocal, kKey)), 0) << z;
  }
}

TEST(SyntheticSensorTest, NoDepthAtEdgesAndInTheShadowToTheLeft) {
  constexpr double kNear = 1.0;
  constexpr double kFar = 2.0;
  cv::Mat depth(20, 400, CV_32FC1, cv::Scalar(kFar));
  depth.colRange(200, 300) = kNear;
  const cv::Mat measured = MeasureDepth(depth, kSensorFocal, kKey);
  // The difference of disparities, with 1 / (8 kInverseDepthStep) = 43.9 px m.
  const int shadow = static_cast<int>(43.9 * (1.0 / kNear - 1.0 / kFar));
  const cv::Mat row = measured.row(10);
  EXPECT_EQ(cv::countNonZero(row.colRange(0, 197 - shadow)), 197 - shadow);
  EXPECT_EQ(cv::countNonZero(row.colRange(202 - shadow, 201)), 0);
  EXPECT_EQ(cv::countNonZero(row.colRange(201, 299)), 98);
  EXPECT_EQ(cv::countNonZero(row.colRange(299, 301)), 0);
  EXPECT_EQ(cv::countNonZero(row.colRange(301, 400)), 99);
}

// Depth of a plane through the optical axis at 2 m, tilted away to the right by
// `slant_deg` relative to the ray.
cv::Mat SlantedPlane(double slant_deg) {
  cv::Mat depth(20, 41, CV_32FC1);
  const double slope = std::tan(slant_deg * M_PI / 180.0);
  for (int u = 0; u < depth.cols; ++u) {
    depth.col(u) = 2.0 / (1.0 - slope * (u - 20) / kSensorFocal);
  }
  return depth;
}

TEST(SyntheticSensorTest, NoDepthOnSurfacesSeenAtASlant) {
  const int centre = 20;
  const auto valid = [&](double slant_deg) {
    return MeasureDepth(SlantedPlane(slant_deg), kSensorFocal, kKey)
               .at<float>(10, centre) > 0.0f;
  };
  EXPECT_TRUE(valid(70.0));
  EXPECT_TRUE(valid(-70.0));
  EXPECT_FALSE(valid(84.0));
  EXPECT_FALSE(valid(-84.0));
}

TEST(SyntheticSensorTest, ColorNoiseHasItsSigma) {
  constexpr double kGray = 100.0;
  cv::Mat color(200, 300, CV_8UC3, cv::Scalar::all(kGray));
  AddColorNoise(kKey, &color);
  const Moments noise = MomentsOf(color.reshape(1));
  // Rounding to whole levels adds 1/12; the sample has 180000 values.
  EXPECT_NEAR(noise.sigma, std::sqrt(kColorSigma * kColorSigma + 1.0 / 12.0),
              0.02);
  EXPECT_NEAR(noise.mean, kGray, 0.03);
}

TEST(SyntheticSensorTest, EncodesDepthInRawUnits) {
  const cv::Mat depth = (cv::Mat_<float>(1, 3) << 0.0f, 1.00009f, 20.0f);
  const cv::Mat raw = EncodeDepth(depth, 5000.0);
  ASSERT_EQ(raw.type(), CV_16UC1);
  EXPECT_EQ(raw.at<uint16_t>(0), 0);
  EXPECT_EQ(raw.at<uint16_t>(1), 5000);
}

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

// The last band of an image may be incomplete.
TEST(SyntheticExposureTest, ShowsEachBandOfRowsAtItsTime) {
  constexpr int kRows = 100;
  const Renderer renderer(MakeScene("room", 1),
                          {160, kRows, kFocal, kFocal, 79.5, 49.5, 0, 0, 0});
  constexpr double kMiddle = 1.0;  // s; the camera is fast there
  const cv::Mat instant = renderer.Render(Handheld(kMiddle)).depth;
  for (const double readout : {0.03, -0.03}) {
    const Shutter shutter = {0.0, readout};
    const cv::Mat rolled =
        Expose(renderer, kFocal, Handheld, kMiddle, {0.0, 1.0, readout}).depth;
    for (int first = 0; first < kRows; first += Renderer::kBandRows) {
      const cv::Range rows(first, std::min(first + Renderer::kBandRows, kRows));
      const double middle = (rows.start + rows.end - 1) / 2.0;
      const Rigid3d pose = Handheld(kMiddle + shutter.RowTime(middle, kRows));
      const cv::Mat then = renderer.Render(pose).depth.rowRange(rows);
      // A pixel or two differ at edges, where faces overlap.
      EXPECT_LE(cv::countNonZero(then != rolled.rowRange(rows)), 2) << first;
      if (std::abs(middle - kRows / 2) < Renderer::kBandRows) continue;
      EXPECT_GT(
          cv::countNonZero(instant.rowRange(rows) != rolled.rowRange(rows)),
          500)
          << first;
    }
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
