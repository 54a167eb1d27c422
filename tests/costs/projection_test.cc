#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "core/estimation/motion_cost.h"
#include "costs/cost_factory.h"
#include "costs/parts/image_error.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

constexpr double kProjectionTolerance = 1e-12;  // rounding of a few operations

Eigen::Vector3d Project(double x, double y, double z) {
  const double q[3] = {x, y, z};
  const Projection<double> projection(q);
  return Eigen::Map<const Eigen::Vector3d>(projection.m());
}

TEST(ProjectionTest, IsThePinholeInFrontOfTheCamera) {
  for (const double z : {kNearestDepth, 0.4, 1.0, 8.0, 1e3}) {
    const Eigen::Vector3d m = Project(0.3, -0.2, z);
    const Eigen::Vector3d expected(0.3 / z, -0.2 / z, 1.0 / z);
    EXPECT_LE((m - expected).norm(), kProjectionTolerance * expected.norm())
        << z;
  }
}

// In front of the camera, at the transition and behind.
TEST(ProjectionTest, DerivativeEqualsTheOracle) {
  using Jet = ceres::Jet<double, 3>;
  for (const double z : {4.0, kNearestDepth, 0.05, 0.0, -3.0}) {
    const Jet q[3] = {Jet(0.3, 0), Jet(-0.2, 1), Jet(z, 2)};
    const Projection<Jet> jet(q);
    const double at[3] = {0.3, -0.2, z};
    const Projection<double> projection(at);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d dq = Eigen::Vector3d::Unit(k);
      double dm[3];
      projection.Derivative(dq.data(), dm);
      for (int i = 0; i < 3; ++i) {
        const double size = std::max(1.0, jet.m()[i].v.norm());
        EXPECT_NEAR(dm[i], jet.m()[i].v[k], kProjectionTolerance * size) << z;
      }
    }
  }
}

TEST(ProjectionTest, GoesOnSmoothlyAndGrowsBehindTheCamera) {
  // Continuous with slope -1/z0^2; the second-order term is h^2 / z0^3.
  constexpr double h = 1e-7;
  const double above = Project(0.0, 0.0, kNearestDepth + h).z();
  const double at = Project(0.0, 0.0, kNearestDepth).z();
  const double below = Project(0.0, 0.0, kNearestDepth - h).z();
  const double slope = -1.0 / (kNearestDepth * kNearestDepth);
  EXPECT_NEAR((above - at) / h, slope, 1e-3);
  EXPECT_NEAR((at - below) / h, slope, 1e-3);
  double last = at;
  for (const double z : {0.05, 0.0, -0.1, -1.0, -10.0}) {
    const double w = Project(0.0, 0.0, z).z();
    EXPECT_TRUE(std::isfinite(w));
    EXPECT_GT(w, last) << z;
    last = w;
  }
}

// If the current camera is rotated by 180 degrees, all points are behind it. A
// plain pinhole would mirror them, which no image cost may accept.
TEST(ProjectionTest, PointsBehindTheCameraCostMore) {
  RandomWorld world(8);
  const Rigid3d truth = world.Motion(0.05, 0.05);
  const Correspondences matches = world.Matches(100, 0.0, truth);
  const MotionVector zero = MotionVector::Zero();
  for (const char* name :
       {"reprojection", "reprojection_depth", "bidirectional_image"}) {
    const std::unique_ptr<MotionCost> cost = MakeCost(name);
    cost->Bind({&matches});
    cost->Associate(truth);
    std::vector<double> in_front, behind;
    cost->SquaredNorms(LinearizationPoint(truth).DerivativesAt(zero.data()),
                       &in_front);
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)}) {
      const Rigid3d turned(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, axis)),
                           Eigen::Vector3d::Zero());
      const Rigid3d motion = turned * truth;
      cost->SquaredNorms(LinearizationPoint(motion).DerivativesAt(zero.data()),
                         &behind);
      for (size_t i = 0; i < behind.size(); ++i) {
        EXPECT_TRUE(std::isfinite(behind[i])) << name;
        EXPECT_GT(behind[i], 100.0 * (1.0 + in_front[i])) << name;
      }
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
