#include "core/geometry/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace rgbd_pose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(CameraTest, ProjectsTheOpticalAxisToThePrincipalPoint) {
  for (const std::string& name : CameraPresetNames()) {
    const Camera camera = CameraPreset(name)->camera;
    const Vector2d pixel = camera.Project(Vector3d(0, 0, 2.5));
    EXPECT_DOUBLE_EQ(pixel.x(), camera.cx) << name;
    EXPECT_DOUBLE_EQ(pixel.y(), camera.cy) << name;
  }
}

TEST(CameraTest, ProjectsRightAndDown) {
  const Camera camera;
  const Vector2d pixel = camera.Project(Vector3d(0.2, 0.1, 2.0));
  EXPECT_DOUBLE_EQ(pixel.x(), 319.5 + 52.5);
  EXPECT_DOUBLE_EQ(pixel.y(), 239.5 + 26.25);
}

// OpenCV's model worked out by hand: x = 0.3, y = -0.2, r^2 = 0.13.
TEST(CameraTest, DistortsAsOpenCvDocuments) {
  Camera camera{640, 480, 500, 400, 320, 240, 0.1, -0.2, 0.01, -0.02, 0.3};
  const double radial =
      1 + 0.1 * 0.13 - 0.2 * 0.13 * 0.13 + 0.3 * 0.13 * 0.13 * 0.13;
  const double x =
      0.3 * radial + 2 * 0.01 * 0.3 * -0.2 - 0.02 * (0.13 + 2 * 0.3 * 0.3);
  const double y =
      -0.2 * radial + 0.01 * (0.13 + 2 * 0.2 * 0.2) - 2 * 0.02 * 0.3 * -0.2;
  const Vector2d pixel = camera.Project(Vector3d(0.6, -0.4, 2.0));
  EXPECT_NEAR(pixel.x(), 500 * x + 320, 1e-10);
  EXPECT_NEAR(pixel.y(), 400 * y + 240, 1e-10);
}

TEST(CameraTest, UndistortInvertsProjectEverywhereInTheImage) {
  constexpr double kTolerancePx = 1e-10;
  for (const std::string& name : CameraPresetNames()) {
    const Camera camera = CameraPreset(name)->camera;
    double largest = 0.0;
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const Vector3d point = camera.Unproject(Vector2d(u, v), 1.7);
        ASSERT_EQ(point.z(), 1.7);
        const double error = (camera.Project(point) - Vector2d(u, v)).norm();
        ASSERT_TRUE(error >= 0.0) << name << " at " << u << ", " << v;
        largest = std::max(largest, error);
      }
    }
    EXPECT_LT(largest, kTolerancePx) << name;
  }
}

// r - 0.3 r^3 rises up to r = 1 / sqrt(0.9) only. No ray is seen outside, and
// points beyond that radius, which would be seen inside again, are not meant.
TEST(CameraTest, UndistortGivesNothingBeyondWhereTheLensFolds) {
  constexpr double kTolerancePx = 1e-10;
  // Some 0.1 px at the fold, where steps of Newton's method are no use.
  constexpr double kBand = 1e-3;
  Camera camera = {640, 480, 320.0, 320.0, 319.5, 239.5, -0.3};
  const double fold = 1.0 / std::sqrt(0.9);
  const double last_seen = fold * (1.0 - 0.3 * fold * fold);
  int inside = 0, outside = 0;
  for (int v = 0; v < camera.height; v += 3) {
    for (int u = 0; u < camera.width; u += 3) {
      const Vector2d pixel(u, v);
      const double seen = camera.Ray(u, v).head<2>().norm();
      const Vector2d ideal = camera.Undistort(pixel);
      if (seen > last_seen) {
        EXPECT_TRUE(std::isnan(ideal.x()) && std::isnan(ideal.y())) << pixel;
        ++outside;
      } else if (seen < last_seen - kBand) {
        const Vector3d ray = camera.Ray(ideal.x(), ideal.y());
        EXPECT_LT((camera.Project(ray) - pixel).norm(), kTolerancePx) << pixel;
        EXPECT_LT(ray.head<2>().norm(), fold) << pixel;
        ++inside;
      }
    }
  }
  EXPECT_GT(inside, 10000);
  EXPECT_GT(outside, 10000);
}

// This barrel lens folds at r = 2.5, far from the start of Newton's method,
// from where a whole step would lead across the fold.
TEST(CameraTest, UndistortStaysOnThisSideOfTheFold) {
  constexpr double kTolerancePx = 1e-10;
  Camera camera = {640, 480, 200.0, 200.0, 319.5, 239.5, -0.4, 0.12};
  camera.k3 = -0.01;
  double fold = 0.0;
  while (camera.ProjectDerivative({fold, 0.0})(0, 0) > 0.0) fold += 1e-4;
  const double last_seen =
      (camera.Project({fold, 0.0, 1.0}).x() - camera.cx) / camera.fx;
  int inside = 0;
  for (int v = 0; v < camera.height; v += 3) {
    for (int u = 0; u < camera.width; u += 3) {
      const Vector2d pixel(u, v);
      if (camera.Ray(u, v).head<2>().norm() > 0.999 * last_seen) continue;
      const Vector2d ideal = camera.Undistort(pixel);
      const Vector3d ray = camera.Ray(ideal.x(), ideal.y());
      EXPECT_LT((camera.Project(ray) - pixel).norm(), kTolerancePx) << pixel;
      EXPECT_LT(ray.head<2>().norm(), fold) << pixel;
      ++inside;
    }
  }
  EXPECT_GT(inside, 30000);
}

TEST(CameraTest, ChecksItsParameters) {
  EXPECT_EQ(Camera{}.Check(), "");
  Camera nan_fx, negative_fy, centre_outside, no_height;
  nan_fx.fx = std::nan("");
  negative_fy.fy = -480;
  centre_outside.cx = 700;
  no_height.height = 0;
  for (const Camera& bad : {nan_fx, negative_fy, centre_outside, no_height}) {
    EXPECT_NE(bad.Check(), "");
  }
}

TEST(CameraTest, DoubtsExchangedNumbers) {
  for (const std::string& name : CameraPresetNames()) {
    EXPECT_EQ(CameraPreset(name)->camera.SanityWarning(), "") << name;
  }
  Camera camera;
  std::swap(camera.cx, camera.cy);
  EXPECT_THAT(camera.SanityWarning(), testing::HasSubstr("principal point"));
  camera = Camera{};
  camera.fy = 480.0;
  EXPECT_THAT(camera.SanityWarning(),
              testing::HasSubstr("fx 525 and fy 480 differ by more than 5 %"));
  // The principal point is valid for 640 x 480, but images are half that size.
  camera = Camera{};
  camera.width = 320;
  camera.height = 240;
  camera.cx = 310.0;
  camera.cy = 230.0;
  EXPECT_THAT(camera.SanityWarning(), testing::HasSubstr("320 x 240"));
}

TEST(CameraTest, UnknownPresetIsEmpty) {
  EXPECT_FALSE(CameraPreset("lidar").has_value());
  EXPECT_TRUE(CameraPreset("tum_fr3").has_value());
}

TEST(CameraTest, PresetsAreSound) {
  for (const std::string& name : CameraPresetNames()) {
    EXPECT_EQ(CameraPreset(name)->camera.Check(), "") << name;
  }
}

}  // namespace
}  // namespace rgbd_pose
