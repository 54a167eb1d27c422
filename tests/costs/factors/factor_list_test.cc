// The Jacobian of every factor of the list, and what its residual means.

#include "costs/factors/factor_list.h"

#include <gtest/gtest.h>

#include <string>

#include "core/factors/check_factor.h"
#include "tests/support/both_jacobians.h"

namespace rgbd_pose {
namespace {

template <typename Factor>
class FactorListTest : public testing::Test {};

TYPED_TEST_SUITE(FactorListTest, AsGTestTypes<FactorTypes>::type, CostName);

TYPED_TEST(FactorListTest, JacobianIsRight) {
  FactorSampler random(1);
  CheckFactorOptions options;
  // Rounding alone; the largest error at these states is 1e-14.
  options.autodiff_tolerance = 1e-12;
  for (int i = 0; i < 10; ++i) {
    options.seed = 100 + i;  // other numbers than the measurements have
    EXPECT_EQ(CheckFactor(TypeParam::Sample(&random), options), "");
  }
}

}  // namespace
}  // namespace rgbd_pose
