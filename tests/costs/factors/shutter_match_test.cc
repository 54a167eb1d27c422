// Matches of rolling shutters, over poses and velocities of both frames.

#include "costs/factors/shutter_match.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "core/factors/check_factor.h"
#include "core/geometry/twist.h"
#include "costs/cost_list.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/both_jacobians.h"

namespace rgbd_pose {
namespace {

template <typename Type>
struct Scene {
  explicit Scene(unsigned seed) : world(seed), random(seed) {
    ref = PoseFrom(world.Motion(2.0, 2.0));
    const Rigid3d motion = world.Motion(0.1, 0.3);
    cur = PoseFrom(Rigid3d(ref.q, ref.p) * motion.Inverse());
    twist_ref = random.template Vector<6>(1.0);
    twist_cur = random.template Vector<6>(1.0);
    factor.ref_seconds = random.Uniform(-0.02, 0.02);
    factor.cur_seconds = random.Uniform(-0.02, 0.02);
    const auto at_row = [](const PoseOf<double>& pose,
                           const MotionVector& twist, double seconds) {
      const PoseOf<double> later = PoseAfter(pose, twist, seconds);
      return Rigid3d(later.q, later.p);
    };
    const Rigid3d between =
        at_row(cur, twist_cur, factor.cur_seconds).Inverse() *
        at_row(ref, twist_ref, factor.ref_seconds);
    const MotionPrior prior = world.Prior(between, 0.3);
    Correspondences matches;
    // Epipolar lines are for matches without depth.
    do {
      matches = world.Matches(1, 0.0, between, /*noise=*/false, 0.25);
    } while (!Type::Pack({matches, between, &prior}, 0,
                         factor.match.columns.data()));
  }

  std::vector<std::vector<double>> Blocks() const {
    std::vector<std::vector<double>> blocks;
    for (const auto& [pose, twist] :
         {std::pair(ref, twist_ref), std::pair(cur, twist_cur)}) {
      const PoseVector x = PoseVectorOf(Rigid3d(pose.q, pose.p));
      blocks.emplace_back(x.data(), x.data() + x.size());
      blocks.emplace_back(twist.data(), twist.data() + twist.size());
    }
    return blocks;
  }

  RandomWorld world;
  FactorSampler random;
  PoseOf<double> ref, cur;
  MotionVector twist_ref, twist_cur;
  ShutterMatchFactor<Type> factor;
};

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
    const Scene<TypeParam> scene(i);
    options.seed = i;
    options.near = scene.Blocks();
    EXPECT_EQ(CheckFactor(scene.factor, options), "");
  }
}

// Exact observations of rows that were exposed at different poses.
TEST(ShutterMatchValuesTest, RowsAreExposedAtTheirTimes) {
  for (int i = 0; i < 10; ++i) {
    Scene<BidirectionalPoint> scene(i);
    Eigen::Matrix<double, BidirectionalPoint::kRows, 1> r;
    const auto norm = [&] {
      scene.factor.Residual(scene.ref, scene.twist_ref, scene.cur,
                            scene.twist_cur, r.data());
      return r.norm();
    };
    EXPECT_LT(norm(), 1e-9);
    scene.factor.ref_seconds += 0.03;
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
