// Residual types without a Jacobian get one by automatic differentiation.

#include "costs/assembly/autodiff_jacobian.h"

#include <ceres/loss_function.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/util/input_error.h"
#include "core/util/lane_math.h"
#include "costs/assembly/cost_of.h"
#include "costs/cost_list.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/both_jacobians.h"
#include "tests/support/evaluate_problem.h"
#include "tests/support/problem_sums.h"

namespace {

// A cost defined outside the project that calls all available functions, with
// the match's and the motion's numbers. All residuals are 0 for e = 0.
struct WithFunctions : rgbd_pose::ForwardError {
  static constexpr char kName[] = "with_functions";
  static constexpr int kRows = 3, kDegreesOfFreedom = 3;
  static constexpr bool kIsWhitened = false;

  template <typename M, typename D, typename T>
  static void Residual(const rgbd_pose::RotationAndCenter<M>& motion,
                       const D* columns, T* r) {
    using rgbd_pose::abs, rgbd_pose::sqrt, rgbd_pose::cbrt, rgbd_pose::exp,
        rgbd_pose::log, rgbd_pose::sin, rgbd_pose::cos, rgbd_pose::tan,
        rgbd_pose::asin, rgbd_pose::acos, rgbd_pose::atan, rgbd_pose::tanh,
        rgbd_pose::pow, rgbd_pose::atan2, rgbd_pose::hypot;
    T e[3];
    Error(motion, columns, e);
    const D depth = log(exp(columns[5])) + 0.1 * cbrt(abs(columns[0]));
    const T x = e[0] / depth, y = e[1] / depth, z = e[2] / depth;
    r[0] = atan(x) + sin(y) * cos(y) + 0.1 * tanh(y) * sqrt(1.0 + x * x);
    r[1] = tan(y) + asin(0.5 * y) - acos(0.5 * y) + acos(0.0 * y) +
           atan2(y, depth) + atan2(y, 2.0);
    r[2] = log(1.0 + pow(z, 2.0) + z) + pow(2.0, z) - pow(depth / depth, z) +
           hypot(z, 1.0 + 0.0 * z) - 1.0;
  }
};

}  // namespace

namespace rgbd_pose {
namespace {

// PointToPoint without its Jacobian.
struct WithoutJacobian : ForwardError {
  static constexpr char kName[] = "without_jacobian";
  static constexpr int kRows = 3;
  static constexpr int kDegreesOfFreedom = 3;
  static constexpr AssociationPolicy kAssociation = PointToPoint::kAssociation;
  static constexpr bool kIsWhitened = false;
  static constexpr int kColumns = PointToPoint::kColumns;

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    return PointToPoint::Pack(input, i, columns);
  }
  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    PointToPoint::Residual(motion, columns, r);
  }
};
static_assert(!kHas<JacobianOf, WithoutJacobian>);

static_assert(AllHaveJacobians(ResidualTypes()),
              "a cost of this project is differentiated by hand");

// Not a multiple of any number of lanes.
constexpr int kMatches = 301;

TEST(AutodiffJacobianTest, SumsAreThoseOfTheJacobianByHand) {
  RandomWorld world(3);
  const Rigid3d truth = world.Motion(0.2, 0.2);
  const Correspondences matches = world.Matches(kMatches, 0.2, truth);
  MotionVector x;
  x << world.Vector(0.05), world.Vector(0.05);
  const MotionDerivatives motion =
      LinearizationPoint(truth).DerivativesAt(x.data());
  const ceres::HuberLoss loss(1.5);
  NormalEquations sums[2];
  MotionMatrix scatters[2] = {MotionMatrix::Zero(), MotionMatrix::Zero()};
  const std::unique_ptr<MotionCost> costs[2] = {MakeCost<PointToPoint>(),
                                                MakeCost<WithoutJacobian>()};
  for (int i = 0; i < 2; ++i) {
    costs[i]->Bind({&matches});
    costs[i]->Associate(truth);
    costs[i]->Linearise(motion, &loss, &sums[i]);
    costs[i]->AddScoreOuterProduct(motion, &loss, &scatters[i]);
  }
  ASSERT_GT(sums[0].hessian.norm(), 1.0);
  EXPECT_EQ(sums[1].cost, sums[0].cost);
  EXPECT_LE(SumsError(sums[1], sums[0]), 1e-12);
  EXPECT_TRUE(scatters[1].isApprox(scatters[0], 1e-12));
}

TEST(AutodiffJacobianTest, AllAssembliesFindTheMotion) {
  RandomWorld world(4);
  const Rigid3d truth = world.Motion(0.1, 0.1);
  const Correspondences matches = world.Matches(kMatches, 0.0, truth, false);
  for (const Assembly assembly :
       {Assembly::kPerMatch, Assembly::kAutodiff, Assembly::kCompressed}) {
    EstimatorOptions options;
    options.assembly = assembly;
    Estimator estimator(options, MakeCost<WithoutJacobian>(), nullptr);
    const MotionEstimate estimate = estimator.Estimate(matches);
    const Rigid3d error = estimate.cur_from_prev.Inverse() * truth;
    EXPECT_LT(error.translation.norm(), 1e-9);
    EXPECT_LT(error.Angle(), 1e-9);
  }
}

// Lanes give the values of scalars, and derivatives equal those of Jets.
TEST(AutodiffJacobianTest, FunctionsAreThereForAllScalars) {
  RandomWorld world(5);
  const Rigid3d truth = world.Motion(0.1, 0.1);
  const Correspondences matches = world.Matches(kMatches, 0.1, truth);
  const LinearizationPoint origin(world.Motion(0.01, 0.01) * truth);
  const std::unique_ptr<MotionCost> cost = MakeCost<WithFunctions>();
  cost->Bind({&matches});
  cost->Associate(truth);
  ceres::HuberLoss loss(0.1);
  const auto sums = [&](Assembly assembly) {
    return EvaluateProblem(cost.get(), assembly, origin, &loss,
                           MotionVector::Constant(0.01));
  };
  const NormalEquations expected = sums(Assembly::kPerMatch);
  EXPECT_GT(expected.cost, 0.1);
  for (const Assembly assembly : {Assembly::kAutodiff, Assembly::kCompressed}) {
    EXPECT_LE(SumsError(sums(assembly), expected), 1e-12);
  }
}

TEST(EstimatorOfOneCostTest, NeedsIt) {
  EXPECT_THROW(Estimator({}, nullptr, nullptr), InputError);
}

}  // namespace
}  // namespace rgbd_pose
