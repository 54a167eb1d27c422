#include "core/geometry/closed_form.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Numbers of a few metres have 16 digits; sums of a hundred numbers lose some.
constexpr double kRounding = 1e-13;

// Weight of 1 mm: except for lines, extents are far larger than this noise.
constexpr double kWeight = 1e6;

PairMoments MomentsOf(const std::vector<Vector3d>& sources,
                      const Rigid3d& target_from_source) {
  PairMoments moments;
  for (const Vector3d& source : sources) {
    moments.Add(target_from_source * source, source, kWeight);
  }
  return moments;
}

std::vector<Vector3d> RandomPoints(int count, RandomWorld* world) {
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) points.push_back(world->Vector(2.0));
  return points;
}

TEST(ClosedFormTest, IsExactWithoutNoise) {
  RandomWorld world(1);
  for (const int count : {3, 4, 10, 100}) {
    for (int trial = 0; trial < 30; ++trial) {
      const Rigid3d truth = world.Motion(M_PI, 3.0);
      const auto fit =
          UmeyamaAlignment(MomentsOf(RandomPoints(count, &world), truth));
      ASSERT_TRUE(fit.has_value());
      // Three points can be nearly collinear: ten times the rounding.
      EXPECT_LE(ErrorOf(*fit, truth).angle, 10 * kRounding);
      EXPECT_LE(ErrorOf(*fit, truth).translation, 100 * kRounding);
    }
  }
}

TEST(ClosedFormTest, KeepsItsDigitsFarFromTheOrigin) {
  RandomWorld world(2);
  const Rigid3d truth = world.Motion(1.0, 1.0);
  std::vector<Vector3d> points = RandomPoints(100, &world);
  for (Vector3d& point : points) point += Vector3d(1e6, -1e6, 1e6);
  const auto fit = UmeyamaAlignment(MomentsOf(points, truth));
  ASSERT_TRUE(fit.has_value());
  // The points themselves are rounded to 1e-10 m. Their sums of squares about
  // the origin would be rounded to 1e-4 m^2.
  EXPECT_LE(ErrorOf(*fit, truth).angle, 1e-10);
}

// A weight has the effect of repeating the pair.
TEST(ClosedFormTest, WeightsCountPairs) {
  RandomWorld world(3);
  PairMoments weighted, repeated;
  for (const int weight : {1, 2, 3, 4, 5}) {
    const Vector3d source = world.Vector(2.0);
    const Vector3d target = source + world.Vector(0.1);
    weighted.Add(target, source, kWeight * weight);
    for (int i = 0; i < weight; ++i) repeated.Add(target, source, kWeight);
  }
  const auto a = UmeyamaAlignment(weighted);
  const auto b = UmeyamaAlignment(repeated);
  ASSERT_TRUE(a && b);
  EXPECT_LE(ErrorOf(*a, *b).angle, kRounding);
  EXPECT_LE(ErrorOf(*a, *b).translation, kRounding);
  EXPECT_NEAR(weighted.spread, repeated.spread, kRounding * weighted.spread);
}

// No further rotation or translation reduces the squared distances.
TEST(ClosedFormTest, MinimisesWeightedSquares) {
  RandomWorld world(4);
  const Rigid3d truth = world.Motion(1.0, 1.0);
  std::vector<Vector3d> sources = RandomPoints(30, &world), targets;
  std::vector<double> weights;
  PairMoments moments;
  for (const Vector3d& source : sources) {
    targets.push_back(truth * source + world.Vector(0.3));
    weights.push_back(world.Uniform(0.1, 1.0) * kWeight);
    moments.Add(targets.back(), source, weights.back());
  }
  const auto fit = UmeyamaAlignment(moments);
  ASSERT_TRUE(fit.has_value());
  const auto squares = [&](const Rigid3d& motion) {
    double sum = 0.0;
    for (size_t i = 0; i < sources.size(); ++i) {
      sum += weights[i] * (targets[i] - motion * sources[i]).squaredNorm();
    }
    return sum;
  };
  const double least = squares(*fit);
  for (int trial = 0; trial < 100; ++trial) {
    EXPECT_GT(squares(world.Motion(0.01, 0.01) * *fit), least);
  }
}

TEST(ClosedFormTest, TooFewOrALineLeaveTheMotionOpen) {
  RandomWorld world(5);
  const Rigid3d truth = world.Motion(1.0, 1.0);
  EXPECT_FALSE(UmeyamaAlignment(PairMoments()).has_value());
  EXPECT_FALSE(UmeyamaAlignment(MomentsOf(RandomPoints(2, &world), truth)));
  const Vector3d point = world.Vector(1.0), along = world.Vector(1.0);
  std::vector<Vector3d> line;
  for (int i = 0; i < 50; ++i) line.push_back(point + i * along);
  EXPECT_FALSE(UmeyamaAlignment(MomentsOf(line, truth)).has_value());
  EXPECT_FALSE(UmeyamaAlignment(MomentsOf(std::vector(50, point), truth)));
  const Vector3d nan(std::nan(""), 0.0, 0.0);
  EXPECT_FALSE(
      UmeyamaAlignment(MomentsOf({point, along, nan}, truth)).has_value());
}

TEST(ClosedFormTest, WhatIsNotFiniteDeterminesNoRotation) {
  for (const double value : {std::nan(""), 1.0 / 0.0}) {
    Eigen::Matrix3d m = 5.0 * Eigen::Matrix3d::Identity();
    m(1, 2) = value;
    EXPECT_EQ(NearestRotation(m).stiffness, 0.0);
    EXPECT_EQ(NearestRotation(m).rotation, Eigen::Matrix3d::Identity());
  }
}

// A distance from the line of one sigma is noise; of ten sigmas, a shape.
TEST(ClosedFormTest, NoiseIsNoShape) {
  RandomWorld world(6);
  const double sigma = 1.0 / std::sqrt(kWeight);
  for (const bool is_shape : {false, true}) {
    PairMoments moments;
    for (int i = 0; i < 100; ++i) {
      const double off = is_shape ? world.Normal(10.0 * sigma) : 0.0;
      const Vector3d source(0.02 * i, off, 2.0);
      const Vector3d noise(world.Normal(sigma), world.Normal(sigma),
                           world.Normal(sigma));
      moments.Add(source + noise, source, kWeight);
    }
    EXPECT_EQ(UmeyamaAlignment(moments).has_value(), is_shape);
  }
}

TEST(ClosedFormTest, NeverReflects) {
  RandomWorld world(7);
  for (int trial = 0; trial < 100; ++trial) {
    Matrix3d m;
    m << world.Vector(1.0), world.Vector(1.0), world.Vector(1.0);
    if (trial % 2 == 0) m.col(2) = m.col(0) + m.col(1);  // a plane
    const NearestRotation nearest(m);
    EXPECT_NEAR(nearest.rotation.determinant(), 1.0, kRounding);
    // No other rotation has a larger trace.
    const double most = (nearest.rotation.transpose() * m).trace();
    for (int i = 0; i < 100; ++i) {
      const Matrix3d other =
          world.Motion(M_PI, 0.0).rotation.toRotationMatrix();
      EXPECT_LE((other.transpose() * m).trace(), most + kRounding);
    }
  }
}

// The trace falls by stiffness / 2 * angle^2 about the weakest axis.
TEST(ClosedFormTest, StiffnessIsTheLeastCurvature) {
  RandomWorld world(8);
  Matrix3d m;
  m << world.Vector(1.0), world.Vector(1.0), world.Vector(1.0);
  const NearestRotation nearest(m);
  const double most = (nearest.rotation.transpose() * m).trace();
  constexpr double kAngle = 1e-3;  // the next term of cos is 1e-6 of this
  double least_fall = 1e9;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::AngleAxisd turn(kAngle, world.Vector(1.0).normalized());
    const Matrix3d turned = turn * nearest.rotation;
    least_fall = std::min(least_fall, most - (turned.transpose() * m).trace());
  }
  // The nearest of 20000 axes is within about 2 degrees of the weakest.
  EXPECT_NEAR(least_fall / (0.5 * kAngle * kAngle), nearest.stiffness,
              0.01 * m.norm());
}

}  // namespace
}  // namespace rgbd_pose
