// Compares the lens models with OpenCV's.

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <vector>

#include "core/geometry/camera.h"

namespace rgbd_pose {
namespace {

constexpr double kTolerancePx = 1e-6;

std::vector<cv::Point3d> Points() {
  std::vector<cv::Point3d> points;
  for (double x = -1.0; x <= 1.0; x += 0.25) {
    for (double y = -0.8; y <= 0.8; y += 0.2) points.emplace_back(x, y, 1.3);
  }
  return points;
}

cv::Matx33d Intrinsics(const Camera& c) {
  return {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0};
}

void ExpectPixels(const Camera& camera,
                  const std::vector<cv::Point2d>& expected) {
  const std::vector<cv::Point3d> points = Points();
  ASSERT_EQ(expected.size(), points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d pixel =
        camera.Project({points[i].x, points[i].y, points[i].z});
    EXPECT_NEAR(pixel.x(), expected[i].x, kTolerancePx);
    EXPECT_NEAR(pixel.y(), expected[i].y, kTolerancePx);
  }
}

TEST(LensOpenCvTest, RationalIsProjectPoints) {
  for (const std::vector<double>& coefficients :
       {std::vector<double>{0.1, -0.05, 0.002, -0.003, 0.01},
        std::vector<double>{0.47, -2.5, 0.0009, -0.0003, 1.48, 0.35, -2.33,
                            1.41}}) {
    Camera camera = {1280, 720, 610, 611, 638, 367};
    ASSERT_TRUE(camera.SetDistortion(LensModel::kRational, coefficients));
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(Points(), cv::Vec3d(), cv::Vec3d(), Intrinsics(camera),
                      coefficients, pixels);
    ExpectPixels(camera, pixels);
  }
}

TEST(LensOpenCvTest, EquidistantIsFisheyeProjectPoints) {
  Camera camera = {848, 800, 285, 286, 423, 399};
  const std::vector<double> coefficients = {-0.008, 0.045, -0.042, 0.008};
  ASSERT_TRUE(camera.SetDistortion(LensModel::kEquidistant, coefficients));
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(Points(), pixels, cv::Vec3d(), cv::Vec3d(),
                             Intrinsics(camera), coefficients);
  ExpectPixels(camera, pixels);
}

}  // namespace
}  // namespace rgbd_pose
