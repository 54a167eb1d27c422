// The three assemblies of direct costs are the same problem: equal cost,
// gradient and J^T J, and the estimator finds the same motion.

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <tuple>

#include "core/estimation/batch_loss.h"
#include "core/estimation/estimator.h"
#include "core/factors/motion_between.h"
#include "core/factors/pose_manifold.h"
#include "costs/direct_cost_factory.h"
#include "costs/factors/pair.h"
#include "robust/m_estimator.h"
#include "tests/support/direct_pair.h"
#include "tests/support/evaluate_problem.h"
#include "tests/support/motion_error.h"
#include "tests/support/problem_sums.h"

namespace rgbd_pose {
namespace {

const DirectPair& Pair() {
  static const DirectPair pair(SyntheticDataset(SmallImages()), 10, 12);
  return pair;
}

DirectOptions FewPoints() {
  DirectOptions options;
  options.max_points = 800;
  return options;
}

class DirectAssemblyTest
    : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(DirectAssemblyTest, CostGradientAndHessianAreEqual) {
  const auto& [cost_name, loss_name] = GetParam();
  const auto cost = MakeDirectCost(cost_name, FewPoints());
  const auto loss = ParseLoss(loss_name).Make(cost->degrees_of_freedom());
  const Rigid3d motion =
      Rigid3d(Eigen::Quaterniond::Identity(), {0.004, 0.002, -0.003}) *
      Pair().cur_from_prev;
  cost->Bind(Pair().data());
  cost->Associate(motion);
  EXPECT_GE(cost->matches().size(), 200u);
  // At the motion of the association: elsewhere, the compressed block repeats
  // it.
  const LinearizationPoint origin(motion);
  const MotionVector x = MotionVector::Zero();
  const NormalEquations expected =
      EvaluateProblem(cost.get(), Assembly::kPerMatch, origin, loss.get(), x);
  constexpr double kEqual = 1e-10;  // sums of some hundred terms
  for (const Assembly assembly : {Assembly::kAutodiff, Assembly::kCompressed}) {
    EXPECT_LE(
        SumsError(EvaluateProblem(cost.get(), assembly, origin, loss.get(), x),
                  expected),
        kEqual);
  }
}

// Over the poses of two frames somewhere in the world.
TEST_P(DirectAssemblyTest, APairFactorIsTheSameOverPoses) {
  const auto& [cost_name, loss_name] = GetParam();
  const auto cost = MakeDirectCost(cost_name, FewPoints());
  const auto loss = ParseLoss(loss_name).Make(cost->degrees_of_freedom());
  const Rigid3d motion = Pair().cur_from_prev;
  cost->Bind(Pair().data());
  cost->Associate(motion);
  ScaledLoss scaled(loss.get(), 1.0, cost->information_factor());
  const NormalEquations by_motion = EvaluateProblem(
      cost.get(), Assembly::kPerMatch, LinearizationPoint(motion), &scaled,
      MotionVector::Zero());
  EXPECT_GT(by_motion.cost, 0.0);
  const Rigid3d ref =
      Rigid3d::FromRotationVector({0.3, -0.2, 0.5}, {1.0, 2.0, -0.5});
  std::array<PoseVector, 2> poses = {PoseVectorOf(ref),
                                     PoseVectorOf(ref * motion.Inverse())};
  const PoseOf<double> ref_pose = PoseFrom(ref);
  const MotionJacobians by(
      ref_pose, MotionBetween(ref_pose, PoseFrom(ref * motion.Inverse())));
  Eigen::Matrix<double, 6, 12> J;
  J << by.by_ref, by.by_cur;

  ceres::Problem problem;
  for (PoseVector& pose : poses) AddPose(pose.data(), &problem);
  problem.AddResidualBlock(
      new PairFactor({MakeDirectCost(cost_name, FewPoints()),
                      ParseLoss(loss_name).Make(cost->degrees_of_freedom())},
                     Pair().data(), motion),
      nullptr, poses[0].data(), poses[1].data());
  constexpr double kEqual = 1e-10;  // sums of some hundred terms
  EXPECT_LE(
      SumsError(SumsOf(&problem),
                ProblemSums{by_motion.cost, J.transpose() * by_motion.gradient,
                            J.transpose() * by_motion.hessian * J}),
      kEqual);
}

INSTANTIATE_TEST_SUITE_P(
    CostsAndLosses, DirectAssemblyTest,
    ::testing::Combine(::testing::ValuesIn(DirectCostNames()),
                       ::testing::ValuesIn(MEstimatorNames())),
    [](const auto& info) {
      return std::get<0>(info.param) + "_" + std::get<1>(info.param);
    });

// To 1 % of the effect of noise: all assemblies take the same steps.
TEST(DirectEstimateTest, IsTheSameByAllAssemblies) {
  for (const char* cost : {"photometric", "inverse_depth", "projective_plane",
                           "photometric+projective_plane"}) {
    const auto estimate = [cost](Assembly assembly) {
      EstimatorOptions options = DirectEstimatorOptions();
      options.assembly = assembly;
      options.max_iterations = 50;
      options.step_tolerance = 1e-7;
      MotionEstimate result;
      Estimator(options, MakeDirectCosts(cost, "huber"))
          .Estimate(Pair().data(), Rigid3d(), &result);
      EXPECT_FALSE(result.covariance.isZero()) << result.reason;
      return result;
    };
    const MotionEstimate expected = estimate(Assembly::kPerMatch);
    const MotionVector sigma = expected.covariance.diagonal().cwiseSqrt();
    for (const Assembly assembly :
         {Assembly::kAutodiff, Assembly::kCompressed}) {
      const MotionError off =
          ErrorOf(estimate(assembly).cur_from_prev, expected.cur_from_prev);
      EXPECT_LE(off.angle, 0.01 * sigma.head<3>().norm()) << cost;
      EXPECT_LE(off.translation, 0.01 * sigma.tail<3>().norm()) << cost;
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
