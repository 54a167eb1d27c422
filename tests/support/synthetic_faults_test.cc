#include "tests/support/synthetic_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kFaultFrames = 12;
constexpr int kFirst = 3;
constexpr int kEnd = 9;

// A smaller image with the same field of view, for speed.
SyntheticOptions SmallOptions(bool noise) {
  SyntheticOptions options;
  options.path = "circle";
  options.frames = kFaultFrames;
  options.noise = noise;
  options.camera.camera = {160, 120, 131.25, 131.25, 79.5, 59.5, 0, 0, 0};
  return options;
}

double ImageDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

class AnyFaultTest : public testing::TestWithParam<FaultKind> {};

TEST_P(AnyFaultTest, LeavesOtherFramesUntouched) {
  const SyntheticOptions options = SmallOptions(true);
  const SyntheticDataset sound(options);
  const FaultyDataset faulty(options, {{GetParam(), kFirst, kEnd}});
  int untouched = 0;
  for (int i = 0; i < faulty.size(); ++i) {
    const int source = faulty.SourceIndex(i);
    if (source >= kFirst && source < kEnd) continue;
    ++untouched;
    const Frame frame = faulty.Read(i);
    const Frame expected = sound.Read(source);
    EXPECT_EQ(ImageDifference(frame.gray, expected.gray), 0.0) << i;
    EXPECT_EQ(ImageDifference(frame.depth, expected.depth), 0.0) << i;
    EXPECT_EQ(frame.timestamp, expected.timestamp);
    EXPECT_EQ(frame.index, i);
    EXPECT_EQ(faulty.WorldFromCam(i).translation,
              sound.WorldFromCam(source).translation);
    EXPECT_EQ(faulty.WorldFromCam(i).rotation.coeffs(),
              sound.WorldFromCam(source).rotation.coeffs());
  }
  EXPECT_EQ(untouched, kFaultFrames - (kEnd - kFirst));
}

TEST_P(AnyFaultTest, GivesTheSameBytesTwice) {
  const SyntheticOptions options = SmallOptions(true);
  const FaultyDataset first(options, {{GetParam(), kFirst, kEnd}});
  const FaultyDataset second(options, {{GetParam(), kFirst, kEnd}});
  second.Read(kFirst + 2);  // the order of reading must not matter
  const Frame a = first.Read(kFirst + 1);
  const Frame b = second.Read(kFirst + 1);
  EXPECT_EQ(ImageDifference(a.gray, b.gray), 0.0);
  EXPECT_EQ(ImageDifference(a.depth, b.depth), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, AnyFaultTest,
                         testing::Values(FaultKind::kBlack, FaultKind::kCovered,
                                         FaultKind::kGain, FaultKind::kTurned,
                                         FaultKind::kBox, FaultKind::kThinned));

TEST(SyntheticFaultsTest, BlackHasDepthAndCoveredHasColour) {
  const SyntheticOptions options = SmallOptions(true);
  const SyntheticDataset sound(options);
  const FaultyDataset faulty(
      options, {{FaultKind::kBlack, 2, 4}, {FaultKind::kCovered, 6, 8}});
  for (const int i : {2, 3}) {
    EXPECT_EQ(cv::countNonZero(faulty.Read(i).gray), 0);
    EXPECT_EQ(ImageDifference(faulty.Read(i).depth, sound.Read(i).depth), 0.0);
  }
  for (const int i : {6, 7}) {
    EXPECT_EQ(cv::countNonZero(faulty.Read(i).depth), 0);
    EXPECT_EQ(ImageDifference(faulty.Read(i).gray, sound.Read(i).gray), 0.0);
  }
}

TEST(SyntheticFaultsTest, GainMultipliesGrayAndSaturates) {
  const SyntheticOptions options = SmallOptions(true);
  const cv::Mat before = SyntheticDataset(options).Read(kFirst).gray;
  for (const double gain : {2.0, 0.5}) {
    const FaultyDataset faulty(options,
                               {{FaultKind::kGain, kFirst, kEnd, gain}});
    const cv::Mat after = faulty.Read(kFirst).gray;
    for (int v = 0; v < before.rows; ++v) {
      for (int u = 0; u < before.cols; ++u) {
        const double exact = std::min(gain * before.at<uint8_t>(v, u), 255.0);
        EXPECT_NEAR(after.at<uint8_t>(v, u), exact, 0.5);  // rounding
      }
    }
  }
}

TEST(SyntheticFaultsTest, TurnsToTheRightAndTheTruthFollows) {
  const SyntheticOptions options = SmallOptions(false);
  const Camera& camera = options.camera.camera;
  const FaultyDataset faulty(options, {{FaultKind::kTurned, kFirst}});
  const Rigid3d turned_from_straight =
      faulty.WorldFromCam(kFirst).Inverse() *
      SyntheticDataset(options).WorldFromCam(kFirst);
  EXPECT_NEAR(turned_from_straight.Angle(), 25.0 * M_PI / 180.0, 1e-12);
  EXPECT_NEAR(turned_from_straight.translation.norm(), 0.0, 1e-12);
  const Vector3d ahead = turned_from_straight * Vector3d::UnitZ();
  EXPECT_NEAR(ahead.x(), -std::sin(25.0 * M_PI / 180.0), 1e-12);
  EXPECT_EQ(faulty.ground_truth()[kFirst].world_from_cam.translation,
            faulty.WorldFromCam(kFirst).translation);

  // Points of the previous frame are where the poses predict them.
  const Frame prev = faulty.Read(kFirst - 1);
  const Frame cur = faulty.Read(kFirst);
  const Rigid3d cur_from_prev =
      faulty.WorldFromCam(kFirst).Inverse() * faulty.WorldFromCam(kFirst - 1);
  int seen = 0;
  int agree = 0;
  for (int v = 2; v < camera.height; v += 3) {
    for (int u = 2; u < camera.width; u += 3) {
      const Vector3d point =
          cur_from_prev * camera.Unproject({u, v}, prev.DepthAt(u, v));
      const Vector2d pixel = camera.Project(point);
      if (point.z() < 0.1 || !camera.Contains(pixel, 1.0)) continue;
      ++seen;
      const double depth =
          cur.DepthAt(static_cast<int>(std::lround(pixel.x())),
                      static_cast<int>(std::lround(pixel.y())));
      // Half a pixel on a slanted surface is 2 cm in these small images.
      agree += std::abs(depth - point.z()) < 0.03;
    }
  }
  ASSERT_GT(seen, 700);
  EXPECT_GT(agree, 0.9 * seen);  // the others are at depth edges
}

// The box in a frame without noise: its pixels and the centre of its front.
struct SeenBox {
  cv::Mat pixels;
  Vector3d centre = Vector3d::Zero();  // in axes of the camera, m
};

SeenBox SeeBox(const FaultyDataset& faulty, const SyntheticDataset& sound,
               int index) {
  const Frame frame = faulty.Read(index);
  SeenBox box;
  box.pixels = frame.depth != sound.Read(index).depth;
  for (int v = 0; v < frame.depth.rows; ++v) {
    for (int u = 0; u < frame.depth.cols; ++u) {
      if (box.pixels.at<uint8_t>(v, u) == 0) continue;
      box.centre +=
          faulty.camera().camera.Unproject({u, v}, frame.DepthAt(u, v));
    }
  }
  box.centre /= cv::countNonZero(box.pixels);
  return box;
}

TEST(SyntheticFaultsTest, TheBoxCirclesInTheWorldBeforeEverythingElse) {
  const SyntheticOptions options = SmallOptions(false);
  const SyntheticDataset sound(options);
  const FaultyDataset faulty(options, {{FaultKind::kBox, kFirst, kEnd}});
  const Rigid3d first_from_world = sound.WorldFromCam(kFirst).Inverse();
  Vector3d last = Vector3d::Zero();
  for (int i = kFirst; i < kEnd; ++i) {
    const SeenBox box = SeeBox(faulty, sound, i);
    EXPECT_NEAR(cv::countNonZero(box.pixels) / (160.0 * 120.0), 0.40, 0.02);
    EXPECT_EQ(cv::countNonZero((faulty.Read(i).depth >= sound.Read(i).depth) &
                               box.pixels),
              0);
    // Sums over whole pixels at the border of the box: half a pixel is 3 mm.
    constexpr double kTolerance = 0.003;
    const Vector3d in_first =
        first_from_world * sound.WorldFromCam(i) * box.centre;
    EXPECT_NEAR(in_first.z(), 0.8, kTolerance);
    EXPECT_NEAR(in_first.head<2>().norm(), 0.1, kTolerance);
    if (i > kFirst) {
      const double speed = (in_first - last).norm() * options.rate_hz;
      EXPECT_NEAR(speed, 0.3, 0.1);  // it moves 10 mm per frame
    }
    last = in_first;
  }
}

TEST(SyntheticFaultsTest, TheBoxCarriesItsPrintAlong) {
  SyntheticOptions options = SmallOptions(false);
  options.path = "still";
  const SyntheticDataset sound(options);
  const FaultyDataset faulty(options, {{FaultKind::kBox, 0}});
  const int later = kFaultFrames - 1;
  const Vector3d shift =
      SeeBox(faulty, sound, later).centre - SeeBox(faulty, sound, 0).centre;
  const double px_per_m = options.camera.camera.fx / 0.8;
  const cv::Matx23d move(1, 0, shift.x() * px_per_m, 0, 1,
                         shift.y() * px_per_m);
  cv::Mat moved, inside;
  cv::warpAffine(faulty.Read(0).gray, moved, move, {160, 120});
  cv::warpAffine(SeeBox(faulty, sound, 0).pixels, inside, move, {160, 120});
  cv::erode(inside > 250, inside, cv::Mat::ones(5, 5, CV_8U));
  const cv::Mat now = faulty.Read(later).gray;
  cv::Scalar mean, spread;
  cv::meanStdDev(now, mean, spread, inside);
  EXPECT_GT(spread[0], 15.0) << "no texture to see it by";
  const auto difference = [&](const cv::Mat& image) {
    cv::Mat difference;
    cv::absdiff(image, now, difference);
    return cv::mean(difference, inside)[0];
  };
  EXPECT_LT(difference(moved), 0.5 * difference(faulty.Read(0).gray));
}

TEST(SyntheticFaultsTest, ThinnedKeepsEveryThirdFrame) {
  const SyntheticOptions options = SmallOptions(true);
  const SyntheticDataset sound(options);
  const FaultyDataset faulty(options, {{FaultKind::kThinned, 2, 9}});
  std::vector<int> kept;
  for (int i = 0; i < faulty.size(); ++i) {
    kept.push_back(faulty.SourceIndex(i));
    EXPECT_EQ(faulty.timestamp(i), sound.timestamp(kept.back()));
    EXPECT_EQ(faulty.ground_truth()[i].timestamp, faulty.timestamp(i));
  }
  EXPECT_EQ(kept, (std::vector<int>{0, 1, 2, 5, 8, 9, 10, 11}));
  const Frame frame = faulty.Read(3);
  EXPECT_EQ(frame.index, 3);
  EXPECT_EQ(frame.timestamp, sound.timestamp(5));
  EXPECT_EQ(ImageDifference(frame.gray, sound.Read(5).gray), 0.0);
}

TEST(SyntheticFaultsTest, RefusesFaultsWithoutSense) {
  const SyntheticOptions options = SmallOptions(true);
  for (const Fault& fault :
       {Fault{FaultKind::kBlack, -1, 3}, Fault{FaultKind::kBlack, 3, 3},
        Fault{FaultKind::kGain, 0, 3, -1.0},
        Fault{FaultKind::kBox, kFaultFrames, kFaultFrames + 5}}) {
    EXPECT_THROW(FaultyDataset(options, {fault}), InputError);
  }
}

}  // namespace
}  // namespace rgbd_pose
