#include "frontend/simulation/synthetic_sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "frontend/simulation/synthetic_hash.h"

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

TEST(SyntheticSensorTest, NoiseDependsOnTheKeyAlone) {
  const cv::Mat wall(40, 40, CV_32FC1, cv::Scalar(2.0));
  const cv::Mat depth = MeasureDepth(wall, kSensorFocal, kKey);
  EXPECT_EQ(
      cv::norm(depth, MeasureDepth(wall, kSensorFocal, kKey), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(depth, MeasureDepth(wall, kSensorFocal, kKey + 7000)), 0);
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

}  // namespace
}  // namespace rgbd_pose
