// What the residuals of factors mean.

#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "core/factors/common_direction.h"
#include "core/factors/distance.h"
#include "core/factors/factor.h"
#include "core/factors/pose_manifold.h"
#include "core/factors/relative_pose.h"
#include "costs/factors/absolute_pose.h"
#include "costs/factors/absolute_position.h"
#include "costs/factors/constant_velocity.h"
#include "costs/factors/gravity.h"
#include "costs/factors/gyroscope.h"
#include "costs/factors/inertial.h"
#include "costs/factors/landmark.h"
#include "costs/factors/map_plane.h"
#include "costs/factors/relative_rotation.h"

namespace rgbd_pose {
namespace {

template <typename Factor, typename... Blocks>
Eigen::Matrix<double, Factor::kRows, 1> ResidualOf(const Factor& factor,
                                                   const Blocks&... blocks) {
  Eigen::Matrix<double, Factor::kRows, 1> r;
  EXPECT_TRUE(factor.Residual(blocks..., r.data()));
  return r;
}

// Near the measured pose the residual is S [omega p].
TEST(FactorValuesTest, AbsolutePoseIsWhitenedInTheTangent) {
  FactorSampler random(1);
  for (int i = 0; i < 20; ++i) {
    const AbsolutePoseFactor factor = AbsolutePoseFactor::Sample(&random);
    const MotionVector d = random.Vector<6>(1e-5);
    PoseVector x = PoseVectorOf(factor.world_from_body);
    PoseBlock::Plus(x.data(), d.data(), x.data());
    EXPECT_TRUE(ResidualOf(factor, PoseBlock::Read(x.data()))
                    .isApprox(factor.sqrt_information * d, 1e-8));
  }
}

TEST(FactorValuesTest, AbsolutePositionIsOfAPointOfTheBody) {
  FactorSampler random(2);
  const Rigid3d pose = random.Motion();
  AbsolutePositionFactor factor = AbsolutePositionFactor::Sample(&random);
  const Eigen::Vector3d off(0.1, 0.2, 0.3);
  factor.in_world = pose * factor.in_body - off;
  EXPECT_TRUE(ResidualOf(factor, PoseFrom(pose))
                  .isApprox(factor.sqrt_information * off, 1e-13));
}

TEST(FactorValuesTest, RelativeRotationIsThatOfRelativePose) {
  FactorSampler random(3);
  for (int i = 0; i < 20; ++i) {
    const PoseOf<double> ref = PoseFrom(random.Motion()),
                         cur = PoseFrom(random.Motion());
    const Rigid3d measured = random.Motion();
    MotionMatrix S = MotionMatrix::Identity();
    S.topLeftCorner<3, 3>() = random.SqrtInformation<3>();
    const RelativePoseFactor both{measured, S};
    const RelativeRotationFactor rotation{measured.rotation,
                                          S.topLeftCorner<3, 3>()};
    EXPECT_TRUE(ResidualOf(rotation, ref, cur)
                    .isApprox(ResidualOf(both, ref, cur).head<3>(), 1e-13));
  }
}

// A body that lies on its back, or nearly: only the exact opposite is a place
// to stay.
TEST(FactorValuesTest, GravityGrowsUpToTheOppositeDirection) {
  FactorSampler random(4);
  for (const double angle : {0.0, 0.1, 1.0, 2.0, 3.0, M_PI - 1e-3}) {
    GravityFactor factor = GravityFactor::Sample(&random);
    const Rigid3d pose = random.Motion();
    const Eigen::Vector3d seen = pose.rotation.conjugate() * factor.in_world;
    factor.in_body = Eigen::AngleAxisd(angle, seen.unitOrthogonal()) * seen;
    EXPECT_NEAR(ResidualOf(factor, PoseFrom(pose)).norm(),
                2.0 * std::sin(angle / 2.0) / factor.sigma, 1e-12);
    PoseVector x = PoseVectorOf(pose);
    ceres::Problem problem;
    AddPose(x.data(), &problem);
    problem.AddResidualBlock(MakeFactor(factor), nullptr, x.data());
    ceres::Solver::Options options;
    options.function_tolerance = 1e-20;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    EXPECT_LT(summary.final_cost, 1e-12) << angle;
  }
}

// The standard deviation of a residual is 1 where velocities change as a random
// walk of the given densities.
TEST(FactorValuesTest, ConstantVelocityIsWhitened) {
  constexpr int kRuns = 2000, kSteps = 100;
  FactorSampler random(5);
  const ConstantVelocityFactor factor{0.25, 0.2, 0.8};
  const double step = factor.seconds / kSteps;
  Eigen::Matrix<double, 12, 12> scatter = Eigen::Matrix<double, 12, 12>::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const PoseOf<double> from = PoseFrom(random.Motion());
    const MotionVector twist = random.Vector<6>(1.0);
    PoseOf<double> pose = from;
    Eigen::Vector3d turning = twist.head<3>();
    Eigen::Vector3d moving = from.q * Eigen::Vector3d(twist.tail<3>());
    for (int i = 0; i < kSteps; ++i) {
      // Uniform, of variance 1.
      const Eigen::Vector3d angular = std::sqrt(step) * factor.angular_density *
                                      random.Vector<3>(std::sqrt(3.0));
      const Eigen::Vector3d linear = std::sqrt(step) * factor.linear_density *
                                     random.Vector<3>(std::sqrt(3.0));
      pose.q = pose.q * RotationBy<double>(step * (turning + 0.5 * angular));
      pose.p += step * (moving + 0.5 * linear);
      turning += angular;
      moving += linear;
    }
    MotionVector changed;
    changed << turning, pose.q.conjugate() * moving;
    const auto r = ResidualOf(factor, from, twist, pose, changed);
    scatter += r * r.transpose() / kRuns;
  }
  // Each entry scatters by sqrt(2 / kRuns) = 0.03 at most.
  constexpr double kFourSigmas = 0.13;
  EXPECT_LT((scatter - scatter.Identity()).lpNorm<Eigen::Infinity>(),
            kFourSigmas)
      << scatter;
}

// Without forces nothing is to be explained, however long it takes.
TEST(FactorValuesTest, ConstantVelocityIsExact) {
  const ConstantVelocityFactor factor{5.0, 0.1, 0.1};
  FactorSampler random(6);
  const PoseOf<double> a = PoseFrom(random.Motion());
  MotionVector twist = random.Vector<6>(1.0);
  const Eigen::Vector3d velocity = a.q * Eigen::Vector3d(twist.tail<3>());
  const PoseOf<double> b{a.q * RotationBy<double>(5.0 * twist.head<3>()),
                         Eigen::Vector3d(a.p + 5.0 * velocity)};
  MotionVector later = twist;
  later.tail<3>() = b.q.conjugate() * velocity;
  EXPECT_LT(ResidualOf(factor, a, twist, b, later).norm(), 1e-12);
}

TEST(FactorValuesTest, DistanceIsBetweenPointsOfTheBodies) {
  FactorSampler random(7);
  DistanceFactor factor = DistanceFactor::Sample(&random);
  const Rigid3d a = random.Motion(), b = random.Motion();
  EXPECT_NEAR(ResidualOf(factor, PoseFrom(a), PoseFrom(b))[0],
              ((a * factor.in_a - b * factor.in_b).norm() - factor.metres) /
                  factor.sigma,
              1e-12);
}

// Both points at one place: no direction, and nothing that is not finite.
TEST(FactorValuesTest, DistanceWithoutADirectionIsFinite) {
  DistanceFactor factor;
  const PoseVector x = PoseVectorOf(Rigid3d());
  for (ceres::CostFunction* function :
       {MakeFactor(factor), MakeAutodiffFactor(factor)}) {
    const std::unique_ptr<ceres::CostFunction> owned(function);
    const double* blocks[] = {x.data(), x.data()};
    PoseVector J[2];
    double* jacobians[] = {J[0].data(), J[1].data()};
    double r = 0.0;
    EXPECT_TRUE(function->Evaluate(blocks, &r, jacobians));
    EXPECT_EQ(r, -factor.metres / factor.sigma);
    for (const PoseVector& block : J) EXPECT_TRUE(block.isZero(0.0));
  }
}

// Without a Jacobian, too: a step to such a pose is not accepted as one where
// both points are at one place.
TEST(FactorValuesTest, DistanceOfAPoseThatIsNotFiniteIsNone) {
  const DistanceFactor factor;
  const PoseOf<double> a = PoseFrom(Rigid3d());
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    PoseOf<double> b = a;
    b.p.x() = bad;
    EXPECT_FALSE(std::isfinite(ResidualOf(factor, a, b)[0]));
    EXPECT_FALSE(std::isfinite(ResidualOf(factor, b, a)[0]));
  }
}

TEST(FactorValuesTest, MapPlaneIsTheDistanceFromThePlane) {
  FactorSampler random(8);
  MapPlaneFactor factor = MapPlaneFactor::Sample(&random);
  const Rigid3d pose = random.Motion();
  factor.distance = factor.normal.dot(pose * factor.in_body) - 0.3;
  EXPECT_NEAR(ResidualOf(factor, PoseFrom(pose))[0], 0.3 / factor.sigma, 1e-12);
}

TEST(FactorValuesTest, LandmarkIsSeenByTheCamera) {
  FactorSampler random(9);
  LandmarkFactor factor = LandmarkFactor::Sample(&random);
  const auto near = LandmarkFactor::Near();
  const Rigid3d anchor = RigidOf(PoseVector(near[0].data())),
                view = RigidOf(PoseVector(near[1].data()));
  using One = Eigen::Matrix<double, 1, 1>;
  const auto residual = [&](double inverse_depth) {
    return ResidualOf(factor, PoseFrom(anchor), PoseFrom(view),
                      One(inverse_depth));
  };
  const Eigen::Vector3d point = view.Inverse() * (anchor * (factor.ray * 2.0));
  const Eigen::Vector2d off =
      (factor.camera.Project(point) - factor.pixel) / factor.sigma_px;
  EXPECT_TRUE(residual(0.5).isApprox(off, 1e-12));
  // A point that is infinitely far away, whatever the positions.
  const Eigen::Vector3d direction =
      view.rotation.conjugate() * (anchor.rotation * factor.ray);
  const Eigen::Vector2d far =
      (factor.camera.Project(direction) - factor.pixel) / factor.sigma_px;
  EXPECT_TRUE(residual(0.0).isApprox(far, 1e-12));
  double r[2];
  factor.ray = -factor.ray;
  EXPECT_FALSE(factor.Residual(PoseFrom(anchor), PoseFrom(view), One(0.0), r));
}

}  // namespace
}  // namespace rgbd_pose
