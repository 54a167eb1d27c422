#include "core/geometry/lens.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/util/vector_lanes.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector2d;
using Jet = ceres::Jet<double, 6>;

struct NamedCamera {
  const char* name;
  Camera camera;
  double largest_tangent;  // of the points tested
};

// Values similar to an Azure Kinect's and to a fisheye's with 150 degrees.
std::vector<NamedCamera> Cameras() {
  Camera plain = {640, 480, 300, 301, 319, 240};
  Camera plumb_bob = plain, rational = plain, fisheye = plain;
  EXPECT_TRUE(plumb_bob.SetDistortion(LensModel::kRational,
                                      {0.1, -0.05, 0.002, -0.003, 0.01}));
  EXPECT_TRUE(rational.SetDistortion(
      LensModel::kRational,
      {0.47, -2.5, 0.0009, -0.0003, 1.48, 0.35, -2.33, 1.41}));
  EXPECT_TRUE(fisheye.SetDistortion(LensModel::kEquidistant,
                                    {-0.02, 0.004, -0.003, 0.0007}));
  return {{"plain", plain, 1.5},
          {"plumb_bob", plumb_bob, 0.9},
          {"rational", rational, 1.2},
          {"fisheye", fisheye, 3.7}};
}

std::vector<Vector2d> Places(double largest) {
  std::vector<Vector2d> places = {{0.0, 0.0}, {1e-7, -1e-8}, {1e-4, 2e-4}};
  for (double r = 0.1; r <= largest; r += 0.2) {
    for (double angle = 0.1; angle < 6.2; angle += 0.7) {
      places.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
  }
  return places;
}

TEST(LensTest, DerivativesAreThoseOfTheOracle) {
  for (const NamedCamera& c : Cameras()) {
    const auto lens = c.camera.MakeLens();
    auto oracle = c.camera.MakeLens<Jet>();
    oracle.k1 = Jet(c.camera.k1, 2);
    oracle.k2 = Jet(c.camera.k2, 3);
    oracle.k3 = Jet(c.camera.k3, 4);
    // For other lens models, k4 is not a coefficient of the numerator.
    const bool has_k4 = c.camera.lens_model == LensModel::kEquidistant;
    if (has_k4) oracle.k4 = Jet(c.camera.k4, 5);
    for (const Vector2d& at : Places(c.largest_tangent)) {
      DistortedPoint<double> hand;
      lens.Distort(at.x(), at.y(), &hand);
      Jet x, y;
      oracle.Distort(Jet(at.x(), 0), Jet(at.y(), 1), &x, &y);
      constexpr double kTolerance = 1e-9;
      EXPECT_NEAR(hand.x, x.a, 1e-15) << c.name;
      EXPECT_NEAR(hand.y, y.a, 1e-15) << c.name;
      EXPECT_NEAR(hand.x_x, x.v[0], kTolerance) << c.name << at.transpose();
      EXPECT_NEAR(hand.x_y, x.v[1], kTolerance) << c.name << at.transpose();
      EXPECT_NEAR(hand.x_y, y.v[0], kTolerance) << c.name << at.transpose();
      EXPECT_NEAR(hand.y_y, y.v[1], kTolerance) << c.name << at.transpose();
      if (!c.camera.HasDistortion()) continue;
      double by[4];
      lens.RadialByCoefficients(at.squaredNorm(), by);
      for (int k = 0; k < (has_k4 ? 4 : 3); ++k) {
        EXPECT_NEAR(at.x() * by[k], x.v[2 + k], kTolerance) << c.name << k;
        EXPECT_NEAR(at.y() * by[k], y.v[2 + k], kTolerance) << c.name << k;
      }
    }
  }
}

TEST(LensTest, LanesAndFloatsAreNumbers) {
  using Two = Lanes<2>::Type;
  for (const NamedCamera& c : Cameras()) {
    const auto lens = c.camera.MakeLens();
    const auto of_float = c.camera.MakeLens<float>();
    DistortedPoint<double> first, second;
    DistortedPoint<Two> both;
    lens.Distort(0.3, -0.2, &first);
    lens.Distort(-0.1, 0.5, &second);
    lens.Distort(Two{0.3, -0.1}, Two{-0.2, 0.5}, &both);
    EXPECT_NEAR(both.x[0], first.x, 1e-15) << c.name;
    EXPECT_NEAR(both.y_y[1], second.y_y, 1e-14) << c.name;
    float x, y;
    of_float.Distort(0.3F, -0.2F, &x, &y);
    EXPECT_NEAR(x, first.x, 1e-6) << c.name;
    EXPECT_NEAR(y, first.y, 1e-6) << c.name;
  }
}

TEST(LensTest, UndistortInvertsEveryLens) {
  for (const NamedCamera& c : Cameras()) {
    for (const Vector2d& at : Places(c.largest_tangent)) {
      const Vector2d pixel = c.camera.Project({at.x(), at.y(), 1.0});
      const Vector2d back = c.camera.Undistort(pixel);
      const Eigen::Vector3d ray = c.camera.Ray(back.x(), back.y());
      EXPECT_LT((ray.head<2>() - at).norm(), 1e-9 * (1.0 + at.squaredNorm()))
          << c.name << " " << at.transpose();
    }
  }
}

// An image corner outside a fisheye's circle; a plumb bob that turns over.
TEST(LensTest, WhatNoRayReachesIsNotANumber) {
  Camera fisheye = Cameras()[3].camera;
  fisheye.fx = fisheye.fy = 150.0;
  EXPECT_TRUE(std::isnan(fisheye.Undistort({0.0, 0.0}).x()));
  EXPECT_TRUE(fisheye.Undistort({160.0, 240.0}).allFinite());
  Camera barrel = {640, 480, 300, 300, 319.5, 239.5, -0.5};
  EXPECT_TRUE(std::isnan(barrel.Undistort({0.0, 0.0}).y()));
  EXPECT_TRUE(barrel.Undistort({200.0, 200.0}).allFinite());
}

TEST(LensTest, CoefficientsComeInTheOrderOfOpenCv) {
  Camera camera;
  const std::vector<double> eight = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_TRUE(camera.SetDistortion(LensModel::kRational, eight));
  EXPECT_EQ(camera.p2, 4.0);
  EXPECT_EQ(camera.k6, 8.0);
  EXPECT_EQ(camera.Distortion(), eight);
  // OpenCV's other coefficients, thin prism and tilt, are not supported.
  EXPECT_FALSE(camera.SetDistortion(LensModel::kRational,
                                    {1, 2, 3, 4, 5, 6, 7, 8, 0, 1, 0, 0}));
  EXPECT_TRUE(camera.SetDistortion(LensModel::kRational,
                                   {1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 0, 0}));
  EXPECT_FALSE(camera.SetDistortion(LensModel::kRational, {1, 2, 3}));
  EXPECT_FALSE(camera.SetDistortion(LensModel::kEquidistant, {1, 2, 3, 4, 5}));
  EXPECT_EQ(camera.Distortion(), eight) << "nothing has changed";
  EXPECT_TRUE(camera.SetDistortion(LensModel::kEquidistant, {1, 2, 3, 4}));
  EXPECT_EQ(camera.k4, 4.0);
  EXPECT_EQ(camera.p1, 0.0) << "of the lens before";
  EXPECT_EQ(camera.Distortion(), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_TRUE(camera.SetDistortion(LensModel::kEquidistant, {0, 0, 0, 0}));
  EXPECT_TRUE(camera.HasDistortion()) << "an angle is no tangent";
  camera.p1 = 0.1;
  EXPECT_NE(camera.Check(), "");
}

}  // namespace
}  // namespace rgbd_pose
