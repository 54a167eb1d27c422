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

SyntheticOptions WithoutNoise(const std::string& path) {
  SyntheticOptions options = PathOptions(path);
  options.noise = false;
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
  SyntheticOptions options = WithoutNoise("xyz");
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

class SyntheticPathImages : public testing::TestWithParam<const char*> {};

TEST_P(SyntheticPathImages, HaveCornersAllOverAndDepthInRange) {
  const SyntheticDataset dataset(PathOptions(GetParam()));
  for (const int index : {0, 40, 80, 120}) {
    const Frame frame = dataset.Read(index);
    const cv::Mat& gray = frame.gray;
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
    EXPECT_GT(cv::countNonZero(frame.depth), 0.9 * 640 * 480) << index;
    double min = 0.0;
    double max = 0.0;
    cv::minMaxLoc(frame.depth, &min, &max, nullptr, nullptr, frame.depth > 0);
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
  SyntheticOptions options = WithoutNoise("handheld");
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
  SyntheticOptions options = WithoutNoise("xyz");
  const Frame exact = SyntheticDataset(options).Read(0);
  const Rigid3d error =
      Rigid3d::FromRotationVector({0.0, 0.02, 0.0}, {0.01, 0.0, 0.0});
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
  const auto refused = [](const auto& spoil) {
    SyntheticOptions options;
    spoil(&options);
    EXPECT_THROW(SyntheticDataset{options}, InputError);
  };
  refused([](SyntheticOptions* options) { options->frames = 0; });
  refused([](SyntheticOptions* options) { options->laps = 0; });
  refused([](SyntheticOptions* options) { options->scene = "garden"; });
  refused([](SyntheticOptions* options) { options->camera.camera.fy = -480; });
  refused([](SyntheticOptions* options) { options->camera.depth_scale = 0; });
  refused([](SyntheticOptions* options) { options->walking_boxes = -1; });
  refused([](SyntheticOptions* options) { options->walking_boxes = 4; });
  refused([](SyntheticOptions* options) {
    options->registration_error.translation.x() = std::nan("");
  });
  const struct {
    double SyntheticOptions::*field;
    double low, high;  // just out of range
  } kRanges[] = {{&SyntheticOptions::rate_hz, 0.0, 1.1e5},
                 {&SyntheticOptions::exposure_s, -0.001, 0.034},
                 {&SyntheticOptions::depth_delay_s, -0.017, 0.017},
                 {&SyntheticOptions::moving_patch, -0.1, 0.46},
                 {&SyntheticOptions::carrier, -0.1, 0.91},
                 {&SyntheticOptions::black_s, -0.1, std::nan("")},
                 {&SyntheticOptions::exposure_drift, -0.1, 1.1}};
  for (const auto& range : kRanges) {
    for (const double bad : {range.low, range.high, std::nan("")}) {
      SCOPED_TRACE(bad);
      refused([&](SyntheticOptions* options) { options->*range.field = bad; });
    }
  }
}

TEST(SyntheticMoversTest, APatchCoversItsShareAndMovesByItself) {
  SyntheticOptions options = WithoutNoise("still");
  const Frame bare = SyntheticDataset(options).Read(0);
  for (const double share : {0.1, 0.4}) {
    options.moving_patch = share;
    const SyntheticDataset dataset(options);
    cv::Rect before;
    for (int i = 40; i < 60; ++i) {
      const Frame frame = dataset.Read(i);
      const cv::Mat covered = frame.depth != bare.depth;
      const double area = static_cast<double>(covered.total());
      EXPECT_NEAR(cv::countNonZero(covered) / area, share, 0.005);
      EXPECT_EQ(cv::countNonZero(frame.depth == frame.depth_scale),
                cv::countNonZero(covered));
      const cv::Rect now = cv::boundingRect(covered);
      if (i > 40) {
        const double step = std::hypot(now.x - before.x, now.y - before.y);
        EXPECT_GE(step, 5.0 - 1.5) << i;  // rounded to whole pixels
        EXPECT_LE(step, 8.0 + 1.5) << i;
      }
      before = now;
    }
  }
}

TEST(SyntheticMoversTest, BoxesWalkBeforeTheRoom) {
  SyntheticOptions options = WithoutNoise("still");
  const Frame bare = SyntheticDataset(options).Read(0);
  options.walking_boxes = 3;
  const SyntheticDataset dataset(options);
  int most = 0;
  for (int i = 0; i < dataset.size(); i += 10) {
    const Frame frame = dataset.Read(i);
    EXPECT_EQ(cv::countNonZero(frame.depth > bare.depth), 0) << i;
    EXPECT_GT(Difference(frame.depth, dataset.Read(i + 1).depth), 0.0) << i;
    most = std::max(most, cv::countNonZero(frame.depth < bare.depth));
  }
  EXPECT_GT(most, 0.2 * bare.depth.total());
  // With a rolling shutter, movers are drawn at the time of each row.
  options.color_shutter.readout = 0.03;
  const Frame rolled = SyntheticDataset(options).Read(50);
  EXPECT_GT(Difference(rolled.color, dataset.Read(50).color), 0.0);
  EXPECT_EQ(Difference(rolled.depth, dataset.Read(50).depth), 0.0);
}

TEST(SyntheticMoversTest, TheMiddleIsBlack) {
  SyntheticOptions options = WithoutNoise("xyz");
  options.frames = 9;
  options.black_s = 0.1;
  const SyntheticDataset dataset(options);
  for (int i = 0; i < options.frames; ++i) {
    const Frame frame = dataset.Read(i);
    EXPECT_EQ(cv::countNonZero(frame.gray) == 0, i >= 3 && i <= 5) << i;
    EXPECT_GT(cv::countNonZero(frame.depth), 0);
  }
}

}  // namespace
}  // namespace rgbd_pose
