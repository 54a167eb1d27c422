// A known distance between two points: its value, and its hand-written Jacobian
// against ceres::Jet.

#include "costs/calibration/landmark_block.h"

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

struct Oracle {
  template <typename T>
  bool operator()(const T* x_a, const T* x_b, const T* y, T* residual) const {
    const RotationAndCenter<T> pose_a = a.PoseAt(x_a), pose_b = b.PoseAt(x_b);
    const T factor = origin.At(y)[kDepthFactor];
    const Eigen::Matrix<T, 3, 1> in_a = known.in_a.cast<T>() * factor;
    const Eigen::Matrix<T, 3, 1> in_b = known.in_b.cast<T>() * factor;
    const Eigen::Matrix<T, 3, 1> place_a =
        pose_a.R.transpose() * in_a + pose_a.C;
    const Eigen::Matrix<T, 3, 1> place_b =
        pose_b.R.transpose() * in_b + pose_b.C;
    const Eigen::Matrix<T, 3, 1> apart = place_a - place_b;
    residual[0] = (apart.norm() - T(known.metres)) / T(known.sigma);
    return true;
  }

  const LinearizationPoint& a;
  const LinearizationPoint& b;
  const CalibrationOrigin& origin;
  const KnownDistance& known;
};

TEST(KnownDistanceTest, EqualsTheOracle) {
  constexpr int kSizes[] = {6, 6, kCalibrationSize};
  RandomWorld world(5);
  for (int i = 0; i < 100; ++i) {
    const LinearizationPoint a(world.Motion(1.0, 2.0)),
        b(world.Motion(1.0, 2.0));
    CalibrationOrigin origin;
    for (int k = 0; k < kCalibrationSize; ++k) {
      origin.start[k] = world.Uniform(0.5, 1.5);
      origin.width[k] = world.Uniform(0.1, 0.5);
    }
    KnownDistance known;
    known.in_a = world.Vector(1.0);
    known.in_b = world.Vector(1.0);
    known.metres = world.Uniform(0.5, 2.0);
    known.sigma = world.Uniform(0.01, 0.1);
    MotionVector x_a, x_b;
    x_a << world.Vector(0.3), world.Vector(0.3);
    x_b << world.Vector(0.3), world.Vector(0.3);
    CalibrationVector y;
    for (double& value : y) value = world.Uniform(-0.5, 0.5);
    const double* x[] = {x_a.data(), x_b.data(), y.data()};
    double r_hand, r_plain, r_jet;
    double J_hand[3][kCalibrationSize], J_jet[3][kCalibrationSize];
    double* hand[] = {J_hand[0], J_hand[1], J_hand[2]};
    double* jet[] = {J_jet[0], J_jet[1], J_jet[2]};
    const KnownDistanceBlock block(a, b, origin, known);
    ASSERT_TRUE(block.Evaluate(x, &r_hand, hand));
    ASSERT_TRUE(block.Evaluate(x, &r_plain, nullptr));
    const ceres::AutoDiffCostFunction<Oracle, 1, 6, 6, kCalibrationSize> oracle(
        new Oracle{a, b, origin, known});
    ASSERT_TRUE(oracle.Evaluate(x, &r_jet, jet));
    EXPECT_NEAR(r_hand, r_jet, 1e-9);
    EXPECT_NEAR(r_plain, r_jet, 1e-9);
    for (int of = 0; of < 3; ++of) {
      for (int k = 0; k < kSizes[of]; ++k) {
        EXPECT_NEAR(J_hand[of][k], J_jet[of][k], 1e-9) << of << ", " << k;
      }
    }
  }
}

// Ceres asks for no derivatives with respect to fixed parameters.
TEST(KnownDistanceTest, GivesTheDerivativesThatAreAskedFor) {
  RandomWorld world(6);
  const LinearizationPoint a(world.Motion(1.0, 2.0)), b(world.Motion(1.0, 2.0));
  CalibrationOrigin origin;
  origin.start.setOnes();
  origin.width.setOnes();
  KnownDistance known;
  known.in_a = world.Vector(1.0);
  const MotionVector zero = MotionVector::Zero();
  const CalibrationVector y = CalibrationVector::Zero();
  const double* x[] = {zero.data(), zero.data(), y.data()};
  const KnownDistanceBlock block(a, b, origin, known);
  double residual, all[3][kCalibrationSize], one[kCalibrationSize];
  double* jacobians[] = {all[0], all[1], all[2]};
  ASSERT_TRUE(block.Evaluate(x, &residual, jacobians));
  const int sizes[] = {6, 6, kCalibrationSize};
  for (int asked = 0; asked < 3; ++asked) {
    double* only[] = {nullptr, nullptr, nullptr};
    only[asked] = one;
    ASSERT_TRUE(block.Evaluate(x, &residual, only));
    for (int k = 0; k < sizes[asked]; ++k) EXPECT_EQ(one[k], all[asked][k]);
  }
}

// Two equal points: the distance has no direction, hence no derivative.
TEST(KnownDistanceTest, OfNothingHasNoSlope) {
  const LinearizationPoint here;
  const MotionDerivatives pose =
      here.DerivativesAt(MotionVector::Zero().eval().data());
  KnownDistance known;
  known.metres = 0.5;
  known.sigma = 0.1;
  const KnownDistanceError error(pose, pose, 1.0, known);
  EXPECT_DOUBLE_EQ(error.r, -5.0);
  EXPECT_TRUE(error.a.isZero());
  EXPECT_TRUE(error.b.isZero());
  EXPECT_EQ(error.by_factor, 0.0);
}

}  // namespace
}  // namespace rgbd_pose
