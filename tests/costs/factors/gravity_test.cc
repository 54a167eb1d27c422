#include "costs/factors/gravity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/factors/check_factor.h"
#include "tests/support/imu_path.h"

namespace rgbd_pose {
namespace {

// What an accelerometer at rest measures is up, in the axes of the body.
TEST(GravityFactorTest, IsZeroAtRest) {
  FactorSampler random(2);
  const PoseOf<double> body = PoseFrom(random.Motion());
  const Eigen::Vector3d gravity(0.0, 0.0, -9.81);
  const Eigen::Vector3d accel = body.q.conjugate() * -gravity;
  const GravityFactor factor = {accel.normalized(), -gravity.normalized(),
                                0.01};
  Eigen::Vector3d r;
  factor.Residual(body, r.data());
  EXPECT_LT(r.norm(), 1e-13);
}

// It grows up to half a turn.
TEST(GravityFactorTest, CountsTheAngleInSigmas) {
  const GravityFactor factor = {{0, 0, 1}, {0, 0, 1}, 0.01};
  for (const double angle : {0.01, 1.0, 2.0, 3.1}) {
    const PoseOf<double> body = {
        Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX())),
        {0, 0, 0}};
    Eigen::Vector3d r;
    factor.Residual(body, r.data());
    EXPECT_NEAR(r.norm(), 2.0 * std::sin(angle / 2.0) / 0.01, 1e-9);
  }
}

}  // namespace
}  // namespace rgbd_pose
