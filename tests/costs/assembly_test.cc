// The three assemblies are the same problem: equal cost, gradient and J^T J,
// and equal steps of Ceres.

#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "core/estimation/motion_cost.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/m_estimator.h"
#include "tests/support/evaluate_problem.h"
#include "tests/support/problem_sums.h"

namespace rgbd_pose {
namespace {

constexpr double kEqual = 1e-10;      // sums of some hundred terms
constexpr double kEqualSteps = 1e-9;  // the same after some iterations

// Enough missing depths on each side for every cost to have both matches that
// it can use and matches that it cannot use.
constexpr double kMissingDepthShare = 0.25;

class AssemblyTest
    : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  AssemblyTest() {
    const MEstimator* row = FindNamed(MEstimators(), std::get<1>(GetParam()));
    cost_ = MakeCost(std::get<0>(GetParam()));
    loss_ = WideLoss(*row, cost_->degrees_of_freedom());
  }

  // Binds `count` matches that the cost can use, a fifth of them outliers,
  // among others that it cannot use (a prior is one block), at a motion off the
  // truth. The baseline is long: near C = 0 all epipolar residuals vanish,
  // outliers push towards it, and one step amplifies rounding a thousandfold.
  void Bind(int count) {
    RandomWorld world(7);
    const Rigid3d truth = world.Motion(0.05, 0.3);
    const Rigid3d guess = world.Motion(0.01, 0.01) * truth;
    const MotionPrior prior = world.Prior(truth, 0.05);
    origin_ = LinearizationPoint(guess);
    matches_.Clear();
    for (int usable = 0; usable < count;) {
      const double outlier_share = matches_.size() % 5 == 0 ? 1.0 : 0.0;
      const Correspondences one =
          world.Matches(1, outlier_share, truth,
                        /*noise=*/true, kMissingDepthShare);
      matches_.Add(one[0].prev, one[0].cur);
      cost_->Bind({&one, &prior});
      cost_->Associate(guess);
      usable += static_cast<int>(cost_->matches().size());
    }
    cost_->Bind({&matches_, &prior});
    cost_->Associate(guess);
    const MotionPrior here{guess, 1e4 * MotionMatrix::Identity()};
    anchor_->Bind({&matches_, &here});
    anchor_->Associate(guess);
    const bool is_prior = cost_->matches()[0] < 0;
    ASSERT_EQ(cost_->matches().size(), is_prior ? 1u : count);
  }

  NormalEquations Evaluate(Assembly assembly, const MotionVector& x) {
    return EvaluateProblem(cost_.get(), assembly, origin_, loss_.get(), x);
  }

  // Adds the same anchor of 1 cm and 0.6 degrees to all. Epipolar matches alone
  // leave the scale open, where steps are only rounding; a prior alone is met
  // exactly, where costs are only rounding.
  ceres::Solver::Summary Solve(Assembly assembly, MotionVector* x) {
    auto problem =
        BuildProblem(cost_.get(), assembly, origin_, loss_.get(), x->data());
    anchor_->AddTo(assembly, origin_, nullptr, x->data(), problem.get());
    ceres::Solver::Options options;
    options.logging_type = ceres::SILENT;
    options.linear_solver_type = ceres::DENSE_QR;
    // Scaling by column norms rounds differently but has no other effect.
    options.max_num_iterations = 8;
    ceres::Solver::Summary summary;
    ceres::Solve(options, problem.get(), &summary);
    return summary;
  }

  LinearizationPoint origin_;
  Correspondences matches_;
  std::unique_ptr<MotionCost> cost_;
  std::unique_ptr<MotionCost> anchor_ = MakeCost("motion_prior");
  std::unique_ptr<ceres::LossFunction> loss_;
};

TEST_P(AssemblyTest, CostGradientAndHessianAreEqual) {
  // Sizes around the number of lanes of the vector loops, to test their tails.
  for (const int count : {6, 7, 8, 9, 301}) {
    Bind(count);
    MotionVector x;
    x << 0.01, -0.02, 0.015, 0.02, 0.01, -0.03;
    const NormalEquations expected = Evaluate(Assembly::kPerMatch, x);
    for (const Assembly assembly :
         {Assembly::kAutodiff, Assembly::kCompressed}) {
      EXPECT_LE(SumsError(Evaluate(assembly, x), expected), kEqual);
    }
  }
}

TEST_P(AssemblyTest, CeresTakesTheSameSteps) {
  Bind(300);
  MotionVector x = MotionVector::Zero();
  const ceres::Solver::Summary expected = Solve(Assembly::kPerMatch, &x);
  for (const Assembly assembly : {Assembly::kAutodiff, Assembly::kCompressed}) {
    MotionVector y = MotionVector::Zero();
    ExpectSameSteps(Solve(assembly, &y), expected, kEqualSteps);
    EXPECT_LE((x - y).norm(), kEqualSteps);
  }
}

TEST_P(AssemblyTest, LineariseIsTheProblemsNormalEquations) {
  Bind(50);
  MotionVector x;
  x << 0.01, -0.02, 0.015, 0.02, 0.01, -0.03;
  const NormalEquations expected = Evaluate(Assembly::kPerMatch, x);
  NormalEquations actual;
  cost_->Linearise(origin_.DerivativesAt(x.data()), loss_.get(), &actual);
  EXPECT_LE(SumsError(actual, expected), kEqual);
}

INSTANTIATE_TEST_SUITE_P(
    CostsAndLosses, AssemblyTest,
    ::testing::Combine(::testing::ValuesIn(CostNames()),
                       ::testing::ValuesIn(MEstimatorNames())),
    [](const auto& info) {
      return std::get<0>(info.param) + "_" + std::get<1>(info.param);
    });

}  // namespace
}  // namespace rgbd_pose
