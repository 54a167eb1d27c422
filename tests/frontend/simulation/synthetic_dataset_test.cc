#include "frontend/simulation/synthetic_dataset.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

SyntheticOptions PathOptions(const std::string& path) {
  SyntheticOptions options;
  options.path = path;
  return options;
}

double Difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

TEST(SyntheticDatasetTest, SameOptionsGiveTheSameBytes) {
  const SyntheticDataset first(PathOptions("xyz"));
  const SyntheticDataset second(PathOptions("xyz"));
  second.Read(3);  // the order of reading must not matter
  const Frame a = first.Read(40);
  const Frame b = second.Read(40);
  EXPECT_EQ(Difference(a.gray, b.gray), 0.0);
  EXPECT_EQ(Difference(a.depth, b.depth), 0.0);
}

TEST(SyntheticDatasetTest, SeedsGiveOtherBytesOfTheSameGeometry) {
  SyntheticOptions options = PathOptions("xyz");
  options.noise = false;
  const Frame one = SyntheticDataset(options).Read(0);
  options.seed = 2;
  const Frame two = SyntheticDataset(options).Read(0);
  EXPECT_GT(Difference(one.color, two.color), 0.0);
  EXPECT_EQ(Difference(one.depth, two.depth), 0.0);
}

TEST(SyntheticDatasetTest, StillDiffersInNoiseOnly) {
  SyntheticOptions options = PathOptions("still");
  const SyntheticDataset noisy(options);
  EXPECT_GT(Difference(noisy.Read(0).gray, noisy.Read(1).gray), 0.0);
  EXPECT_GT(Difference(noisy.Read(0).depth, noisy.Read(1).depth), 0.0);
  options.noise = false;
  const SyntheticDataset clean(options);
  EXPECT_EQ(Difference(clean.Read(0).gray, clean.Read(1).gray), 0.0);
  EXPECT_EQ(Difference(clean.Read(0).depth, clean.Read(1).depth), 0.0);
}

TEST(SyntheticDatasetTest, FramesFitTheInterface) {
  const SyntheticDataset dataset(PathOptions("circle"));
  const Frame frame = dataset.Read(31);
  EXPECT_EQ(frame.index, 31);
  EXPECT_EQ(frame.gray.type(), CV_8UC1);
  EXPECT_EQ(frame.depth.type(), CV_16UC1);
  EXPECT_EQ(frame.gray.size(), cv::Size(640, 480));
  EXPECT_EQ(frame.depth.size(), cv::Size(640, 480));
  EXPECT_EQ(frame.depth_scale, dataset.camera().depth_scale);
  cv::Mat gray;
  cv::cvtColor(frame.color, gray, cv::COLOR_BGR2GRAY);
  EXPECT_EQ(Difference(gray, frame.gray), 0.0);
}

TEST(SyntheticDatasetTest, GroundTruthHasTheStampsOfTheFrames) {
  const SyntheticDataset dataset(PathOptions("xyz"));
  const Trajectory truth = dataset.ground_truth();
  ASSERT_EQ(truth.size(), 150u);
  EXPECT_EQ(truth[0].timestamp, 1000.0);
  EXPECT_EQ(truth[1].timestamp, 1000.033333);
  EXPECT_EQ(truth[149].timestamp, 1004.966667);
  for (int i = 0; i < dataset.size(); ++i) {
    EXPECT_EQ(truth[i].timestamp, dataset.timestamp(i));
    EXPECT_EQ(truth[i].world_from_cam.translation,
              dataset.WorldFromCam(i).translation);
  }
  EXPECT_EQ(dataset.Read(7).timestamp, truth[7].timestamp);
}

// A world point seen in one frame appears in the other frame at the pixel,
// depth and (textures stick to surfaces) gray level predicted by the poses.
TEST(SyntheticDatasetTest, FramesAgreeThroughTheGroundTruth) {
  SyntheticOptions options = PathOptions("pan_tilt");
  options.noise = false;
  const SyntheticDataset dataset(options);
  const Camera& camera = dataset.camera().camera;
  constexpr int kPrev = 10;
  constexpr int kCur = 18;
  const Frame prev = dataset.Read(kPrev);
  const Frame cur = dataset.Read(kCur);
  const Rigid3d cur_from_prev =
      dataset.WorldFromCam(kCur).Inverse() * dataset.WorldFromCam(kPrev);
  // Raw units of 0.2 mm on both sides, and half a pixel on a slanted surface.
  constexpr double kDepthTolerance = 0.01;  // m
  int seen = 0;
  int agree = 0;
  double gray_difference = 0.0;
  for (int v = 4; v < camera.height; v += 9) {
    for (int u = 4; u < camera.width; u += 9) {
      const Vector3d point =
          cur_from_prev * camera.Unproject({u, v}, prev.DepthAt(u, v));
      const Vector2d pixel = camera.Project(point);
      if (!camera.Contains(pixel, 1.0)) continue;
      ++seen;
      const int column = static_cast<int>(std::lround(pixel.x()));
      const int row = static_cast<int>(std::lround(pixel.y()));
      if (std::abs(cur.DepthAt(column, row) - point.z()) > kDepthTolerance) {
        continue;
      }
      ++agree;
      cv::Mat patch;
      cv::getRectSubPix(
          cur.gray, {1, 1},
          {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())},
          patch);
      gray_difference +=
          std::abs(patch.at<uint8_t>(0) - prev.gray.at<uint8_t>(v, u));
    }
  }
  ASSERT_GT(seen, 2500);
  EXPECT_GT(agree, 0.95 * seen);  // the others are at depth edges
  // Interpolation smooths away about two levels. Textures that do not stick
  // would differ by their contrast, more than ten levels.
  EXPECT_LT(gray_difference / agree, 4.0);
}

class SyntheticPathImages : public testing::TestWithParam<const char*> {};

TEST_P(SyntheticPathImages, HaveCornersAllOver) {
  const SyntheticDataset dataset(PathOptions(GetParam()));
  for (const int index : {0, 40, 80, 120}) {
    const cv::Mat gray = dataset.Read(index).gray;
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(gray, corners, 2000, 0.01, 8);
    EXPECT_GE(corners.size(), 300u) << index;
    cv::Mat occupied = cv::Mat::zeros(6, 8, CV_8UC1);
    for (const cv::Point2f& corner : corners) {
      occupied.at<uint8_t>(static_cast<int>(corner.y) / 80,
                           static_cast<int>(corner.x) / 80) = 1;
    }
    EXPECT_GE(cv::countNonZero(occupied), 0.8 * 48) << index;
    std::vector<cv::KeyPoint> keypoints;
    cv::FAST(gray, keypoints, 20);
    EXPECT_GE(keypoints.size(), 300u) << index;
  }
}

TEST_P(SyntheticPathImages, HaveDepthInRange) {
  const SyntheticDataset dataset(PathOptions(GetParam()));
  for (const int index : {0, 60, 110}) {
    const cv::Mat depth = dataset.Read(index).depth;
    EXPECT_GT(cv::countNonZero(depth), 0.9 * 640 * 480) << index;
    double min = 0.0;
    double max = 0.0;
    cv::minMaxLoc(depth, &min, &max, nullptr, nullptr, depth > 0);
    EXPECT_GT(min / 5000.0, 0.6) << index;
    EXPECT_LT(max / 5000.0, 5.0) << index;
  }
}

INSTANTIATE_TEST_SUITE_P(Paths, SyntheticPathImages,
                         testing::Values("xyz", "pan_tilt", "circle",
                                         "handheld"));

// The path repeats after 100 s, far beyond the frames tested above.
TEST(SyntheticDatasetTest, HandheldAlwaysSeesTextureAndDepth) {
  SyntheticOptions options = PathOptions("handheld");
  options.frames = 3000;
  const SyntheticDataset dataset(options);
  for (int index = 0; index < options.frames; index += 187) {
    const Frame frame = dataset.Read(index);
    EXPECT_GT(cv::countNonZero(frame.depth), 0.9 * 640 * 480) << index;
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(frame.gray, corners, 2000, 0.01, 8);
    EXPECT_GE(corners.size(), 500u) << index;
  }
}

TEST(SyntheticDatasetTest, LapsGoToAndFro) {
  SyntheticOptions options = PathOptions("table");
  options.frames = 601;
  const SyntheticDataset once(options);
  options.frames = 2401;
  options.laps = 4;
  const SyntheticDataset laps(options);
  for (const int end : {0, 1200, 2400}) {
    EXPECT_TRUE(laps.WorldFromCam(end).translation.isApprox(
        once.WorldFromCam(0).translation, 1e-12));
  }
  for (const int end : {600, 1800}) {
    EXPECT_TRUE(laps.WorldFromCam(end).translation.isApprox(
        once.WorldFromCam(600).translation, 1e-12));
  }
  EXPECT_TRUE(laps.WorldFromCam(300).translation.isApprox(
      once.WorldFromCam(300).translation, 1e-12));
  double fastest = 0.0;
  for (int i = 1; i <= 2400; ++i) {
    fastest = std::max(fastest, (laps.WorldFromCam(i).translation -
                                 laps.WorldFromCam(i - 1).translation)
                                    .norm());
  }
  EXPECT_LT(fastest * options.rate_hz, 0.8);  // m/s
}

TEST(SyntheticDatasetTest, ExposureChangesColourAlone) {
  SyntheticOptions options = PathOptions("handheld");
  options.noise = false;
  const SyntheticDataset plain(options);
  options.exposure_s = 0.01;
  options.exposure_drift = 0.3;
  const SyntheticDataset exposed(options);
  constexpr int kBrightest = 30;  // a quarter of the drift's period
  const Frame before = plain.Read(kBrightest);
  const Frame after = exposed.Read(kBrightest);
  EXPECT_EQ(Difference(before.depth, after.depth), 0.0);
  EXPECT_EQ(plain.WorldFromCam(kBrightest).translation,
            exposed.WorldFromCam(kBrightest).translation);
  // exp(0.3) = 1.35, reduced by saturation.
  const double gain = cv::mean(after.color)[1] / cv::mean(before.color)[1];
  EXPECT_GT(gain, 1.25);
  EXPECT_LT(gain, 1.36);
}

TEST(SyntheticDatasetTest, RegistrationErrorMovesPoints) {
  SyntheticOptions options = PathOptions("xyz");
  options.noise = false;
  const Frame exact = SyntheticDataset(options).Read(0);
  const Rigid3d error(
      Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Vector3d(0.0, 1.0, 0.0))),
      {0.01, 0.0, 0.0});
  options.registration_error = error;
  const SyntheticDataset dataset(options);
  const Frame frame = dataset.Read(0);
  EXPECT_EQ(Difference(frame.color, exact.color), 0.0);
  const Camera& camera = dataset.camera().camera;
  int seen = 0;
  int agree = 0;
  for (int v = 4; v < camera.height; v += 9) {
    for (int u = 4; u < camera.width; u += 9) {
      const Vector3d moved =
          error * camera.Unproject({u, v}, exact.DepthAt(u, v));
      const Vector2d pixel = camera.Project(moved);
      if (!camera.Contains(pixel, 1.0)) continue;
      EXPECT_GT(pixel.x(), u + 8.0);  // 0.02 rad are 10.5 px
      ++seen;
      const double depth =
          frame.DepthAt(static_cast<int>(std::lround(pixel.x())),
                        static_cast<int>(std::lround(pixel.y())));
      agree += std::abs(depth - moved.z()) < 0.01;
    }
  }
  ASSERT_GT(seen, 2500);
  EXPECT_GT(agree, 0.95 * seen);  // the others are at depth edges
}

TEST(SyntheticDatasetTest, OneFrameAndHugeTimesHaveAPose) {
  SyntheticOptions options;
  options.frames = 1;
  options.laps = 2;
  EXPECT_TRUE(SyntheticDataset(options).WorldFromCam(0).IsFinite());
  options = {};
  options.path = "xyz";
  options.frames = 2;
  options.rate_hz = 1e-10;
  const Rigid3d far = SyntheticDataset(options).WorldFromCam(1);
  EXPECT_LT(far.translation.norm(), 10.0);
}

TEST(SyntheticDatasetTest, RefusesOptionsWithoutSense) {
  SyntheticOptions options;
  options.frames = 0;
  EXPECT_THROW(SyntheticDataset{options}, InputError);
  options = {};
  options.laps = 0;
  EXPECT_THROW(SyntheticDataset{options}, InputError);
  options = {};
  options.rate_hz = 0.0;
  EXPECT_THROW(SyntheticDataset{options}, InputError);
  options = {};
  options.scene = "garden";
  EXPECT_THROW(SyntheticDataset{options}, InputError);
  options = {};
  options.camera.camera.fy = -480.0;
  EXPECT_THROW(SyntheticDataset{options}, InputError);
  options = {};
  options.camera.depth_scale = 0.0;
  EXPECT_THROW(SyntheticDataset{options}, InputError);
  for (const double bad : {-0.001, 0.034, std::nan("")}) {
    options = {};
    options.exposure_s = bad;
    EXPECT_THROW(SyntheticDataset{options}, InputError) << bad;
  }
  for (const double bad : {-0.017, 0.017, std::nan("")}) {
    options = {};
    options.depth_delay_s = bad;
    EXPECT_THROW(SyntheticDataset{options}, InputError) << bad;
  }
  for (const double bad : {-0.1, 0.46, std::nan("")}) {
    options = {};
    options.moving_patch = bad;
    EXPECT_THROW(SyntheticDataset{options}, InputError) << bad;
  }
  for (const int bad : {-1, 4}) {
    options = {};
    options.walking_boxes = bad;
    EXPECT_THROW(SyntheticDataset{options}, InputError) << bad;
  }
  options = {};
  options.black_s = std::nan("");
  EXPECT_THROW(SyntheticDataset{options}, InputError);
  options = {};
  options.registration_error.translation.x() = std::nan("");
  EXPECT_THROW(SyntheticDataset{options}, InputError);
  for (const double bad : {-0.1, 1.1, std::nan("")}) {
    options = {};
    options.exposure_drift = bad;
    EXPECT_THROW(SyntheticDataset{options}, InputError) << bad;
  }
}

}  // namespace
}  // namespace rgbd_pose
