// Compares the hand-written Jacobians of direct costs with ceres::Jet, exactly,
// on columns from rendered images.

#include <gtest/gtest.h>

#include <cmath>

#include "costs/cost_list.h"
#include "tests/support/both_jacobians.h"
#include "tests/support/direct_columns.h"

namespace rgbd_pose {
namespace {

// As in costs/jacobian_test.cc.
constexpr double kTolerance = 1e-12;
constexpr int kMinSamples = 300;

static_assert(AllHaveJacobians(DirectResidualTypes()),
              "a cost of this project is differentiated by hand: give it a "
              "Jacobian");

template <typename Residual>
class DirectJacobianTest : public ::testing::Test,
                           protected BothJacobians<Residual> {};
TYPED_TEST_SUITE(DirectJacobianTest, AsGTestTypes<DirectResidualTypes>::type,
                 CostName);

TYPED_TEST(DirectJacobianTest, EqualsTheOracle) {
  for (const bool is_distorted : {false, true}) {
    const DirectPair pair(SyntheticDataset(SmallImages(is_distorted)), 10, 12);
    const PackedColumns seen =
        SeenColumns<TypeParam>(InputOf(pair, 1, pair.cur_from_prev),
                               PointsOf<TypeParam>(pair, 1, 1000));
    ASSERT_GE(seen.size, kMinSamples);
    const LinearizationPoint origin(pair.cur_from_prev);
    MotionVector x;
    x << 0.01, -0.02, 0.015, 0.02, 0.01, -0.03;
    for (int i = 0; i < seen.size; ++i) {
      double columns[TypeParam::kColumns];
      for (int k = 0; k < TypeParam::kColumns; ++k) {
        columns[k] = seen.values[k * seen.stride + i];
      }
      this->EvaluateBoth(origin, x, columns);
      const double size = std::max(1.0, std::abs(this->jet_r_[0]));
      EXPECT_NEAR(this->hand_r_[0], this->jet_r_[0], kTolerance * size) << i;
      EXPECT_LE(this->RowError(0, 0, 6), kTolerance) << i;
      EXPECT_GT(this->jet_J_.norm(), 0.1) << "a point that says nothing: " << i;
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
