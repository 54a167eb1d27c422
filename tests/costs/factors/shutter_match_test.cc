// Matches of rolling shutters, over poses and velocities of both frames.

#include "costs/factors/shutter_match.h"

#include <gtest/gtest.h>

#include "core/factors/check_factor.h"
#include "core/geometry/twist.h"
#include "costs/cost_list.h"
#include "tests/support/both_jacobians.h"
#include "tests/support/shutter_scene.h"

namespace rgbd_pose {
namespace {

template <typename Type>
class ShutterMatchTest : public testing::Test {};

TYPED_TEST_SUITE(ShutterMatchTest, AsGTestTypes<ResidualTypes>::type, CostName);

TYPED_TEST(ShutterMatchTest, JacobianIsRight) {
  CheckFactorOptions options;
  options.samples = 40;
  options.spread = 0.02;
  options.autodiff_tolerance = 1e-12;
  // Pixels are not smooth over a step of 1 mrad.
  options.difference_tolerance = 1e-4;
  for (int i = 0; i < 10; ++i) {
    ShutterScene<TypeParam> scene(i);
    options.seed = i;
    options.near = scene.Blocks();
    EXPECT_EQ(CheckFactor(scene.Match(), options), "");
  }
}

// Exact observations of rows that were exposed at different poses.
TEST(ShutterMatchValuesTest, RowsAreExposedAtTheirTimes) {
  for (int i = 0; i < 10; ++i) {
    ShutterScene<BidirectionalPoint> scene(i);
    ShutterMatchFactor<BidirectionalPoint> match = scene.Match();
    Eigen::Matrix<double, BidirectionalPoint::kRows, 1> r;
    const auto norm = [&] {
      match.Residual(scene.ref, scene.twist_ref, scene.cur, scene.twist_cur,
                     r.data());
      return r.norm();
    };
    EXPECT_LT(norm(), 1e-9);
    match.ref_seconds += 0.03;
    EXPECT_GT(norm(), 0.1);
  }
}

// The pose of a row is where Twist moves the points of a still scene.
TEST(ShutterMatchValuesTest, MovesAsTwistDoes) {
  FactorSampler random(1);
  const PoseOf<double> pose = PoseFrom(random.Motion());
  const MotionVector x = random.Vector<6>(1.0);
  const Twist twist{x.head<3>(), x.tail<3>()};
  const Eigen::Vector3d point = random.Vector<3>(2.0);
  const auto error = [&](double seconds) {
    const PoseOf<double> later = PoseAfter(pose, x, seconds);
    const Eigen::Vector3d seen =
        later.q.conjugate() *
        Eigen::Vector3d(pose.q * point + pose.p - later.p);
    return (seen - twist.MovedPoint(point, seconds)).norm();
  };
  // Both are of second order: what is left shrinks with the third power.
  EXPECT_LT(error(0.02), 1e-4);
  EXPECT_LT(error(0.01), error(0.02) / 7.0);
}

}  // namespace
}  // namespace rgbd_pose
