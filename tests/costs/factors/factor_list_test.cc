// The Jacobian of every factor of the list.

#include "costs/factors/factor_list.h"

#include <gtest/gtest.h>

#include <string>

namespace rgbd_pose {
namespace {

class FactorListTest : public testing::TestWithParam<ListedFactor> {};

TEST_P(FactorListTest, JacobianIsRight) {
  FactorSampler random(1);
  CheckFactorOptions options;
  // Rounding alone; the largest error at these states is 1e-14.
  options.autodiff_tolerance = 1e-12;
  for (int i = 0; i < 10; ++i) {
    options.seed = 100 + i;  // other numbers than the measurements have
    EXPECT_EQ(CheckFactor(GetParam().sample(&random), options), "");
  }
}

INSTANTIATE_TEST_SUITE_P(Factors, FactorListTest,
                         testing::ValuesIn(ListedFactors()),
                         [](const auto& info) -> std::string {
                           return info.param.name;
                         });

}  // namespace
}  // namespace rgbd_pose
