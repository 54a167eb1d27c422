// Which directions a Hessian leaves undetermined, and how they are named.

#include "core/estimation/degeneracy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/motion.h"

namespace rgbd_pose {
namespace {

constexpr double kMaxDeviation = 0.1;  // rad and m

// Rows of planes with these `normals`, each at 3 x 3 points around (0, 0, 2).
MotionMatrix HessianOfPlanes(const std::vector<Eigen::Vector3d>& normals) {
  MotionMatrix hessian = MotionMatrix::Zero();
  for (const Eigen::Vector3d& normal : normals) {
    for (const double x : {-1.0, 0.0, 1.0}) {
      for (const double y : {-1.0, 0.0, 1.0}) {
        const Eigen::Vector3d point(x, y, 2.0);
        MotionVector row;
        row << point.cross(normal), normal;
        hessian += 1e4 * row * row.transpose();
      }
    }
  }
  return hessian;
}

TEST(DegeneracyTest, AWellKnownMotionHasTheInverseHessian) {
  const MotionMatrix hessian =
      HessianOfPlanes({Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                       Eigen::Vector3d::UnitZ()});
  const Degeneracy result = FindDegeneracy(hessian, 0.0, kMaxDeviation);
  EXPECT_FALSE(result.is_degenerate()) << result.reason;
  EXPECT_TRUE((result.inverse * hessian).isIdentity(1e-9));
}

// A wall straight ahead determines its distance and rotations about x and y.
// Small errors of its normal, by rounding or noise, must not change the
// undetermined directions that are reported.
TEST(DegeneracyTest, TiltDoesNotHideWhatIsOpen) {
  for (const double tilt :
       {0.0, 1e-17, 1e-16, 1e-14, 1e-12, 1e-8, 1e-4, 0.01}) {
    const Degeneracy result = FindDegeneracy(
        HessianOfPlanes({Eigen::Vector3d(tilt, -0.3 * tilt, -1.0)}), 0.0,
        kMaxDeviation);
    EXPECT_TRUE(result.is_degenerate());
    EXPECT_EQ(result.reason.find("rotation about x"), std::string::npos)
        << result.reason;
    EXPECT_EQ(result.reason.find("rotation about y"), std::string::npos)
        << result.reason;
    EXPECT_EQ(result.reason.find("translation along z"), std::string::npos)
        << result.reason;
    EXPECT_NE(result.reason.find("is not determined at all"), std::string::npos)
        << result.reason;
  }
}

TEST(DegeneracyTest, ADirectionThatIsKnownTooLittleIsNamed) {
  MotionMatrix hessian = 1e6 * MotionMatrix::Identity();
  hessian(4, 4) = 25.0;  // standard deviation 0.2 m
  const Degeneracy result = FindDegeneracy(hessian, 0.0, kMaxDeviation);
  EXPECT_TRUE(result.is_degenerate());
  EXPECT_EQ(result.reason,
            "translation along y is not determined (standard deviation 0.2 m)");
  EXPECT_FALSE(FindDegeneracy(hessian, 0.0, 0.21).is_degenerate());
}

// A rotation needs about three times the spurious information of noise.
TEST(DegeneracyTest, ARotationFromNoiseIsNotKnown) {
  MotionMatrix hessian = 1e6 * MotionMatrix::Identity();
  hessian(1, 1) = 1e4;
  EXPECT_FALSE(FindDegeneracy(hessian, 0.3e4, kMaxDeviation).is_degenerate());
  const Degeneracy result = FindDegeneracy(hessian, 0.4e4, kMaxDeviation);
  EXPECT_TRUE(result.is_degenerate());
  EXPECT_EQ(result.reason,
            "rotation about y is not determined: noise alone may give the 0.01 "
            "rad to which it seems known, as where points are on a line or far "
            "away");
}

TEST(DegeneracyTest, NothingIsKnownOfNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(FindDegeneracy(MotionMatrix::Zero(), 0.0, kMaxDeviation).reason,
            "no match has any weight: is the guess far off, are sigmas too "
            "small, or are all points nearer than 0.1 m?");
  EXPECT_EQ(
      FindDegeneracy(MotionMatrix::Constant(nan), 0.0, kMaxDeviation).reason,
      "the Hessian is not finite");
}

// The reason also names a large second component, but not a small one.
TEST(DegeneracyTest, NamesWhatStandsOut) {
  // All translations are known except for one, which has x, y and z parts.
  const Eigen::Vector3d open = Eigen::Vector3d(1.0, -0.6, 0.1).normalized();
  MotionMatrix hessian = 1e6 * MotionMatrix::Identity();
  hessian.bottomRightCorner<3, 3>() -= (1e6 - 1.0) * open * open.transpose();
  EXPECT_EQ(FindDegeneracy(hessian, 0.0, kMaxDeviation).reason,
            "translation along x with translation along y is not determined "
            "(standard deviation 1 m)");
}

// At 2 m: 3 mm along the ray; 0.7 px of f = 500 px across, which is 2.8 mm.
TEST(SpuriousInformationTest, IsTheLeverOfNoise) {
  Camera camera;
  camera.fx = camera.fy = 500.0;
  Correspondences matches(camera);
  Observation seen;
  seen.u = camera.cx;
  seen.v = camera.cy;
  seen.depth = 2.0;
  seen.sigma_px = 0.7;
  seen.sigma_depth = 0.003;
  matches.Add(seen, seen);
  const std::vector<CameraMatches> cameras = {{&matches, 0, Rigid3d()}};
  const double q = 0.003 * 0.003 / (0.0028 * 0.0028);
  const double spurious = (q + 1.0 / q) / 2.0;
  EXPECT_NEAR(SpuriousInformation(cameras, {}), spurious, 1e-12);

  // A missing depth is replaced by the other one; without both, the value is 1.
  Observation blind = seen;
  blind.depth = 0.0;
  matches.Add(blind, seen);
  EXPECT_NEAR(SpuriousInformation(cameras, {}), 2.0 * spurious, 1e-12);
  matches.Add(blind, blind);
  EXPECT_NEAR(SpuriousInformation(cameras, {}), 2.0 * spurious + 1.0, 1e-12);
  EXPECT_NEAR(SpuriousInformation(cameras, {0.5, 0.25, 0.125}),
              0.75 * spurious + 0.125, 1e-12);

  // The matches of another camera follow.
  Correspondences others(camera);
  others.Add(seen, seen);
  EXPECT_NEAR(SpuriousInformation({cameras[0], {&others, 3, Rigid3d()}},
                                  {0.0, 0.0, 0.0, 0.5}),
              0.5 * spurious, 1e-12);
}

}  // namespace
}  // namespace rgbd_pose
