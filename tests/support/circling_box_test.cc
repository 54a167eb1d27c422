#include "tests/support/circling_box.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

constexpr int kFirst = 3;

// Without noise. A smaller image with the same field of view, for speed.
SyntheticOptions SmallOptions(const std::string& path) {
  SyntheticOptions options;
  options.path = path;
  options.frames = 12;
  options.noise = false;
  options.camera.camera = {160, 120, 131.25, 131.25, 79.5, 59.5, 0, 0, 0};
  return options;
}

// The box in a frame: its pixels and the centre of its front.
struct SeenBox {
  cv::Mat gray, pixels;
  Vector3d centre = Vector3d::Zero();  // in axes of the camera, m
};

SeenBox SeeBox(const SyntheticOptions& options, int index) {
  Frame frame = SyntheticDataset(options).Read(index);
  const cv::Mat behind = frame.depth.clone();
  CirclingBox(options, kFirst).DrawInto(index, &frame);
  SeenBox box = {frame.gray, frame.depth != behind};
  EXPECT_EQ(cv::countNonZero((frame.depth >= behind) & box.pixels), 0);
  for (int v = 0; v < frame.depth.rows; ++v) {
    for (int u = 0; u < frame.depth.cols; ++u) {
      if (box.pixels.at<uint8_t>(v, u) == 0) continue;
      box.centre +=
          options.camera.camera.Unproject({u, v}, frame.DepthAt(u, v));
    }
  }
  box.centre /= cv::countNonZero(box.pixels);
  return box;
}

TEST(CirclingBoxTest, CirclesInTheWorldBeforeEverythingElse) {
  const SyntheticOptions options = SmallOptions("circle");
  const SyntheticDataset dataset(options);
  const Rigid3d first_from_world = dataset.WorldFromCam(kFirst).Inverse();
  Vector3d last = Vector3d::Zero();
  for (int i = kFirst; i < kFirst + 6; ++i) {
    const SeenBox box = SeeBox(options, i);
    EXPECT_NEAR(cv::countNonZero(box.pixels) / (160.0 * 120.0), 0.40, 0.02);
    // Sums over whole pixels at the border of the box: half a pixel is 3 mm.
    constexpr double kTolerance = 0.003;
    const Vector3d in_first =
        first_from_world * dataset.WorldFromCam(i) * box.centre;
    EXPECT_NEAR(in_first.z(), 0.8, kTolerance);
    EXPECT_NEAR(in_first.head<2>().norm(), 0.1, kTolerance);
    if (i > kFirst) {
      const double speed = (in_first - last).norm() * options.rate_hz;
      EXPECT_NEAR(speed, 0.3, 0.1);  // it moves 10 mm per frame
    }
    last = in_first;
  }
}

TEST(CirclingBoxTest, CarriesItsPrintAlong) {
  const SyntheticOptions options = SmallOptions("still");
  const SeenBox before = SeeBox(options, kFirst);
  const SeenBox now = SeeBox(options, kFirst + 8);
  const Vector3d shift = now.centre - before.centre;
  const double px_per_m = options.camera.camera.fx / 0.8;
  const cv::Matx23d move(1, 0, shift.x() * px_per_m, 0, 1,
                         shift.y() * px_per_m);
  cv::Mat moved, inside;
  cv::warpAffine(before.gray, moved, move, {160, 120});
  cv::warpAffine(before.pixels, inside, move, {160, 120});
  cv::erode(inside > 250, inside, cv::Mat::ones(5, 5, CV_8U));
  cv::Scalar mean, spread;
  cv::meanStdDev(now.gray, mean, spread, inside);
  EXPECT_GT(spread[0], 15.0) << "no texture to see it by";
  const auto difference = [&](const cv::Mat& image) {
    cv::Mat difference;
    cv::absdiff(image, now.gray, difference);
    return cv::mean(difference, inside)[0];
  };
  EXPECT_LT(difference(moved), 0.5 * difference(before.gray));
}

}  // namespace
}  // namespace rgbd_pose
