// Residual types without a Jacobian of their own get one.

#include "costs/assembly/autodiff_jacobian.h"

#include <ceres/loss_function.h>
#include <gtest/gtest.h>

#include "core/estimation/estimator.h"
#include "core/util/input_error.h"
#include "costs/assembly/cost_of.h"
#include "costs/cost_list.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

// As PointToPoint, but for the Jacobian.
struct WithoutJacobian : ForwardError {
  static constexpr char kName[] = "without_jacobian";
  static constexpr int kRows = 3;
  static constexpr int kIndependentRows = 3;
  static constexpr bool kFreezesWeights = false;
  static constexpr bool kIsWhitened = false;
  static constexpr int kColumns = PointToPoint::kColumns;

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    return PointToPoint::Pack(input, i, columns);
  }
  template <typename M, typename D, typename T>
  static void Residual(const MotionPose<M>& motion, const D* columns, T* r) {
    PointToPoint::Residual(motion, columns, r);
  }
};
static_assert(!HasJacobian<WithoutJacobian>::value);

template <typename... Types>
constexpr bool AllHaveJacobians(TypeList<Types...>) {
  return (HasJacobian<Types>::value && ...);
}
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
  const MotionDerivatives motion = MotionOrigin(truth).DerivativesAt(x.data());
  const ceres::HuberLoss loss(1.5);
  NormalEquations sums[2];
  MotionMatrix scatters[2] = {MotionMatrix::Zero(), MotionMatrix::Zero()};
  const std::unique_ptr<Cost> costs[2] = {MakeCost<PointToPoint>(),
                                          MakeCost<WithoutJacobian>()};
  for (int i = 0; i < 2; ++i) {
    costs[i]->Bind({matches, truth});
    costs[i]->Linearise(motion, &loss, &sums[i]);
    costs[i]->AddScatter(motion, &loss, &scatters[i]);
  }
  ASSERT_GT(sums[0].hessian.norm(), 1.0);
  EXPECT_EQ(sums[1].cost, sums[0].cost);
  EXPECT_TRUE(sums[1].gradient.isApprox(sums[0].gradient, 1e-12));
  EXPECT_TRUE(sums[1].hessian.isApprox(sums[0].hessian, 1e-12));
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

TEST(EstimatorOfOneCostTest, NeedsIt) {
  EXPECT_THROW(Estimator({}, nullptr, nullptr), InputError);
}

}  // namespace
}  // namespace rgbd_pose
