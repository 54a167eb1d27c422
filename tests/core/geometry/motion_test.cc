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

constexpr double kRounding = 1e-13;

TEST(MotionTest, RotationIsZThenYThenX) {
  const double angles[3] = {0.3, -0.4, 0.5};
  const Matrix3d expected =
      (AngleAxisd(0.5, Vector3d::UnitZ()) *
       AngleAxisd(-0.4, Vector3d::UnitY()) * AngleAxisd(0.3, Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_LE((RotationFromAngles(angles) - expected).norm(), kRounding);
}

TEST(MotionTest, MapsPointsAsTheThesisDoes) {
  MotionVector x;
  x << 0.1, 0.2, -0.3, 0.5, -0.6, 0.7;
  const Vector3d prev(0.3, -0.2, 2.0);
  const Vector3d expected =
      RotationFromAngles(x.data()) * (prev - Vector3d(x.tail<3>()));
  EXPECT_LE((RigidFromMotion(x) * prev - expected).norm(), kRounding);
}

// The centre of the current camera, seen from the current camera, is its
// origin: the direction of the pose.
TEST(MotionTest, CIsTheCurrentCentreInThePreviousFrame) {
  MotionVector x;
  x << 0.1, 0.2, -0.3, 0.5, -0.6, 0.7;
  EXPECT_LE((RigidFromMotion(x) * Vector3d(x.tail<3>())).norm(), kRounding);
}

TEST(MotionTest, VectorAndRigidAreInverse) {
  RandomWorld world(3);
  for (int i = 0; i < 200; ++i) {
    const Rigid3d motion = world.Motion(3.1, 2.0);
    const Rigid3d back = RigidFromMotion(MotionFromRigid(motion));
    const Rigid3d difference = back.Inverse() * motion;
    EXPECT_LE(difference.Angle(), 1e-12);
    EXPECT_LE(difference.translation.norm(), 1e-12);
  }
}

TEST(MotionTest, GimbalLockGivesTheMotionBack) {
  for (const double beta : {M_PI / 2, -M_PI / 2}) {
    MotionVector x;
    x << 0.4, beta, -0.7, 1.0, 2.0, 3.0;
    const Rigid3d motion = RigidFromMotion(x);
    const Rigid3d back = RigidFromMotion(MotionFromRigid(motion));
    // The lost half of the digits: sqrt(eps) of an angle at the pole.
    EXPECT_LE((back.Inverse() * motion).Angle(), 1e-7);
  }
}

TEST(MotionTest, DerivativesEqualJets) {
  using Jet = ceres::Jet<double, 6>;
  RandomWorld world(4);
  for (int i = 0; i < 100; ++i) {
    const MotionOrigin origin(world.Motion(2.0, 1.0));
    MotionVector x;
    x << world.Vector(1.0), world.Vector(1.0);
    Jet jets[6];
    for (int k = 0; k < 6; ++k) jets[k] = Jet(x[k], k);
    const MotionPose<Jet> expected = origin.PoseAt(jets);
    const MotionDerivatives actual = origin.DerivativesAt(x.data());
    for (int row = 0; row < 3; ++row) {
      EXPECT_NEAR(actual.C[row], expected.C[row].a, kRounding);
      for (int col = 0; col < 3; ++col) {
        EXPECT_NEAR(actual.R(row, col), expected.R(row, col).a, kRounding);
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(actual.dR[k](row, col), expected.R(row, col).v[k],
                      kRounding);
        }
      }
    }
  }
}

TEST(MotionTest, ParametersCountFromTheOrigin) {
  const Rigid3d guess(Eigen::Quaterniond(AngleAxisd(0.7, Vector3d::UnitY())),
                      Vector3d(0.1, 0.2, 0.3));
  const MotionVector zero = MotionVector::Zero();
  const Rigid3d motion = MotionOrigin(guess).CurFromPrev(zero.data());
  EXPECT_LE((motion.Inverse() * guess).Angle(), kRounding);
  EXPECT_LE((motion.translation - guess.translation).norm(), kRounding);
}

TEST(Rigid3Test, NamesCancelInProducts) {
  RandomWorld world(5);
  const Rigid3d a_from_b = world.Motion(1.0, 1.0);
  const Rigid3d b_from_c = world.Motion(1.0, 1.0);
  const Vector3d point_in_c(0.1, 0.2, 0.3);
  EXPECT_LE((((a_from_b * b_from_c) * point_in_c) -
             (a_from_b * (b_from_c * point_in_c)))
                .norm(),
            kRounding);
  EXPECT_LE((a_from_b.Inverse() * (a_from_b * point_in_c) - point_in_c).norm(),
            kRounding);
}

TEST(Rigid3Test, AngleIsExactForTinyRotations) {
  const Rigid3d tiny(Eigen::Quaterniond(AngleAxisd(1e-9, Vector3d::UnitX())),
                     Vector3d::Zero());
  EXPECT_NEAR(tiny.Angle(), 1e-9, 1e-15);
}

}  // namespace
}  // namespace rgbd_pose
