#include "core/factors/rotations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/factors/sampler.h"

namespace rgbd_pose {
namespace {

// Lengths of rotation vectors (rad) on both sides of where series take over.
constexpr double kAngles[] = {0.0,   1e-9, 0.9e-3, 1.1e-3, 0.9e-2,
                              0.011, 0.5,  3.0,    4.0,    7.0};

TEST(RotationsTest, RotationByIsThatOfAngleAndAxis) {
  FactorSampler random(1);
  for (const double angle : kAngles) {
    const Eigen::Vector3d axis = random.Vector<3>(1.0).normalized();
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle, axis));
    const Eigen::Vector3d omega = angle * axis;
    EXPECT_TRUE(RotationBy(omega).coeffs().isApprox(expected.coeffs(), 1e-15))
        << angle;
  }
}

TEST(RotationsTest, RotationByJacobianIsToTheRight) {
  FactorSampler random(2);
  constexpr double kStep = 1e-4;
  for (const double angle : kAngles) {
    const Eigen::Vector3d omega = angle * random.Vector<3>(1.0).normalized();
    const Eigen::Matrix3d J = RotationByJacobian(omega);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(k);
      const Eigen::Vector3d change =
          RotationVector(RotationBy<double>(omega - d).conjugate() *
                         RotationBy<double>(omega + d)) /
          (2.0 * kStep);
      EXPECT_TRUE(J.col(k).isApprox(change, 1e-7)) << angle;
    }
    EXPECT_TRUE((J * omega).isApprox(omega, 1e-14)) << angle;
  }
}

// No digits are lost on either side of where the series ends. The Jacobian is
// the mean of Exp(-s omega) for s from 0 to 1; three points of Gauss are exact
// to omega^6 / 2e6.
TEST(RotationsTest, RotationByJacobianIsAMeanOfRotations) {
  FactorSampler random(4);
  for (const double angle : {0.0, 1e-4, 0.9e-2, 0.999e-2, 1.001e-2, 0.03}) {
    const Eigen::Vector3d omega = angle * random.Vector<3>(1.0).normalized();
    Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
    for (const auto& [at, weight] :
         {std::pair(-std::sqrt(0.6), 5.0), std::pair(0.0, 8.0),
          std::pair(std::sqrt(0.6), 5.0)}) {
      const Eigen::Vector3d turn = -0.5 * (1.0 + at) * omega;
      mean += weight / 18.0 * RotationBy(turn).toRotationMatrix();
    }
    EXPECT_LT((RotationByJacobian(omega) - mean).norm(), 1e-14) << angle;
  }
}

TEST(RotationsTest, ErrorHasOneSignOnly) {
  FactorSampler random(3);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Quaterniond q = random.Motion().rotation;
    const Eigen::Quaterniond same(-q.coeffs());
    const Eigen::Vector3d error = RotationError(q);
    EXPECT_EQ(error, RotationError(same));
    EXPECT_EQ(RotationErrorJacobian(q), RotationErrorJacobian(same));
    EXPECT_GT(error.dot(RotationVector(q)), 0.0);
  }
}

}  // namespace
}  // namespace rgbd_pose
