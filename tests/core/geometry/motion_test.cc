#include "core/geometry/motion.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMotionRounding = 1e-13;

TEST(MotionTest, RotationIsZThenYThenX) {
  const double angles[3] = {0.3, -0.4, 0.5};
  const Matrix3d expected =
      (AngleAxisd(0.5, Vector3d::UnitZ()) *
       AngleAxisd(-0.4, Vector3d::UnitY()) * AngleAxisd(0.3, Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_LE((RotationFromAngles(angles) - expected).norm(), kMotionRounding);
}

// C is the centre of the current camera in the previous camera: the motion maps
// it to the origin.
TEST(MotionTest, MapsPointsAsTheThesisDoes) {
  MotionVector x;
  x << 0.1, 0.2, -0.3, 0.5, -0.6, 0.7;
  const Vector3d C = x.tail<3>();
  for (const Vector3d& prev : {Vector3d(0.3, -0.2, 2.0), C}) {
    const Vector3d expected = RotationFromAngles(x.data()) * (prev - C);
    EXPECT_LE(
        (LinearizationPoint().CurFromPrev(x.data()) * prev - expected).norm(),
        kMotionRounding);
  }
}

TEST(MotionTest, VectorAndRigidAreInverse) {
  RandomWorld world(3);
  for (int i = 0; i < 200; ++i) {
    const Rigid3d motion = world.Motion(3.1, 2.0);
    const Rigid3d back =
        LinearizationPoint().CurFromPrev(MotionFromRigid(motion).data());
    const Rigid3d difference = back.Inverse() * motion;
    EXPECT_LE(difference.Angle(), 1e-12);
    EXPECT_LE(difference.translation.norm(), 1e-12);
  }
}

TEST(MotionTest, GimbalLockGivesTheMotionBack) {
  for (const double beta : {M_PI / 2, -M_PI / 2}) {
    MotionVector x;
    x << 0.4, beta, -0.7, 1.0, 2.0, 3.0;
    const Rigid3d motion = LinearizationPoint().CurFromPrev(x.data());
    const Rigid3d back =
        LinearizationPoint().CurFromPrev(MotionFromRigid(motion).data());
    // Half of the digits are lost: sqrt(eps) for an angle at the pole.
    EXPECT_LE((back.Inverse() * motion).Angle(), 1e-7);
  }
}

TEST(MotionTest, DerivativesEqualJets) {
  using Jet = ceres::Jet<double, 6>;
  RandomWorld world(4);
  for (int i = 0; i < 100; ++i) {
    const LinearizationPoint origin(world.Motion(2.0, 1.0));
    MotionVector x;
    x << world.Vector(1.0), world.Vector(1.0);
    Jet jets[6];
    for (int k = 0; k < 6; ++k) jets[k] = Jet(x[k], k);
    const RotationAndCenter<Jet> expected = origin.PoseAt(jets);
    const MotionDerivatives actual = origin.DerivativesAt(x.data());
    for (int row = 0; row < 3; ++row) {
      EXPECT_NEAR(actual.C[row], expected.C[row].a, kMotionRounding);
      for (int col = 0; col < 3; ++col) {
        EXPECT_NEAR(actual.R(row, col), expected.R(row, col).a,
                    kMotionRounding);
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(actual.dR[k](row, col), expected.R(row, col).v[k],
                      kMotionRounding);
        }
      }
    }
  }
}

TEST(MotionTest, ParametersCountFromTheOrigin) {
  const Rigid3d guess(Eigen::Quaterniond(AngleAxisd(0.7, Vector3d::UnitY())),
                      Vector3d(0.1, 0.2, 0.3));
  const MotionVector zero = MotionVector::Zero();
  const Rigid3d motion = LinearizationPoint(guess).CurFromPrev(zero.data());
  EXPECT_LE((motion.Inverse() * guess).Angle(), kMotionRounding);
  EXPECT_LE((motion.translation - guess.translation).norm(), kMotionRounding);
}

TEST(Rigid3Test, NamesCancelInProducts) {
  RandomWorld world(5);
  const Rigid3d a_from_b = world.Motion(1.0, 1.0);
  const Rigid3d b_from_c = world.Motion(1.0, 1.0);
  const Vector3d point_in_c(0.1, 0.2, 0.3);
  EXPECT_LE((((a_from_b * b_from_c) * point_in_c) -
             (a_from_b * (b_from_c * point_in_c)))
                .norm(),
            kMotionRounding);
  EXPECT_LE((a_from_b.Inverse() * (a_from_b * point_in_c) - point_in_c).norm(),
            kMotionRounding);
}

TEST(Rigid3Test, AngleIsExactForTinyRotations) {
  const Rigid3d tiny(Eigen::Quaterniond(AngleAxisd(1e-9, Vector3d::UnitX())),
                     Vector3d::Zero());
  EXPECT_NEAR(tiny.Angle(), 1e-9, 1e-15);
}

// Compares with finite differences of the composed motion.
TEST(MotionTest, CovariancesOfComposedMotionsAddUp) {
  const auto rotation = [](const Eigen::Vector3d& omega) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(
        omega.norm(), omega.norm() > 0.0 ? omega.normalized().eval()
                                         : Eigen::Vector3d::UnitX().eval()));
  };
  // The motion changed by an error [omega C].
  const auto with_error = [&](const Rigid3d& motion, const MotionVector& e) {
    const Eigen::Vector3d centre = motion.Inverse().translation + e.tail<3>();
    const Eigen::Quaterniond turned = rotation(e.head<3>()) * motion.rotation;
    return Rigid3d(turned, -(turned * centre));
  };
  const Rigid3d c_from_b(rotation({0.3, -0.8, 0.5}), {0.4, -1.0, 2.0});
  const Rigid3d b_from_a(rotation({-1.1, 0.2, 0.7}), {-0.6, 0.3, 1.5});
  const Rigid3d c_from_a = c_from_b * b_from_a;
  constexpr double kStep = 1e-6;
  MotionMatrix by_cb, by_ba;
  for (int i = 0; i < 6; ++i) {
    const MotionVector step = kStep * MotionVector::Unit(i);
    const auto error_of = [&](const Rigid3d& moved) {
      const Eigen::AngleAxisd turned(moved.rotation *
                                     c_from_a.rotation.conjugate());
      MotionVector error;
      error << turned.angle() * turned.axis(),
          moved.Inverse().translation - c_from_a.Inverse().translation;
      return (error / kStep).eval();
    };
    by_cb.col(i) = error_of(with_error(c_from_b, step) * b_from_a);
    by_ba.col(i) = error_of(c_from_b * with_error(b_from_a, step));
  }
  MotionMatrix cb, ba;  // two arbitrary covariances
  for (int i = 0; i < 36; ++i) {
    cb(i) = std::sin(1.0 + i);
    ba(i) = std::cos(2.0 * i);
  }
  cb = (cb * cb.transpose()).eval();
  ba = (ba * ba.transpose()).eval();
  const MotionMatrix expected =
      by_cb * cb * by_cb.transpose() + by_ba * ba * by_ba.transpose();
  const MotionMatrix actual = ComposedCovariance(c_from_b, cb, b_from_a, ba);
  EXPECT_LE((actual - expected).norm(), 1e-4 * expected.norm());
}

TEST(MotionTest, RotationVectorsGoRoundWhateverTheSignOfTheQuaternion) {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.6, -0.0, 0.8);
  for (const double angle : {0.0, 1e-12, 0.3, 3.1}) {
    const Rigid3d motion =
        Rigid3d::FromRotationVector(angle * axis, {1.0, 2.0, 3.0});
    EXPECT_NEAR(motion.Angle(), angle, 1e-15);
    for (const double sign : {1.0, -1.0}) {
      Eigen::Quaterniond q = motion.rotation;
      q.coeffs() *= sign;
      EXPECT_LE((RotationVector(q) - angle * axis).norm(), 1e-14) << angle;
    }
  }
}

TEST(MotionTest, MahalanobisDistanceCountsSigmasOfRotationAndCentre) {
  const Rigid3d other(Eigen::Quaterniond(0.5, 0.1, -0.7, 0.4),
                      {0.3, -0.2, 0.5});
  const Eigen::Vector3d turn(0.01, 0.0, 0.0), shift(0.0, 0.02, 0.0);
  // Rotated about the axes of the current camera, with its centre moved.
  const Rigid3d turned =
      Rigid3d::FromRotationVector(turn, Eigen::Vector3d::Zero()) * other;
  const Eigen::Vector3d centre = other.Inverse().translation + shift;
  const Rigid3d moved(turned.rotation, -(turned.rotation * centre));
  MotionMatrix covariance = MotionMatrix::Identity();
  covariance.diagonal().head<3>().setConstant(0.005 * 0.005);
  covariance.diagonal().tail<3>().setConstant(0.01 * 0.01);
  EXPECT_NEAR(SquaredMahalanobisDistance(moved, other, covariance), 8.0, 1e-9);
  EXPECT_NEAR(SquaredMahalanobisDistance(other, other, covariance), 0.0, 1e-20);
}

}  // namespace
}  // namespace rgbd_pose
