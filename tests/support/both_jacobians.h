#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>

#include "core/geometry/motion.h"
#include "core/util/type_list.h"
#include "costs/assembly/autodiff_jacobian.h"
#include "costs/assembly/cost_blocks.h"
#include "costs/cost_list.h"

namespace rgbd_pose {

// Residual and Jacobian of one block, by hand and by ceres::Jet.
template <typename Residual>
struct BothJacobians {
  void EvaluateBoth(const LinearizationPoint& origin, const MotionVector& x,
                    const double* columns) {
    const double* parameters[] = {x.data()};
    double* by_hand[] = {hand_J_.data()};
    ASSERT_TRUE(AnalyticBlock<Residual>(origin, columns)
                    .Evaluate(parameters, hand_r_.data(), by_hand));
    double* by_jet[] = {jet_J_.data()};
    OracleBlock<Residual> oracle(new OracleFunctor<Residual>{origin, columns});
    ASSERT_TRUE(oracle.Evaluate(parameters, jet_r_.data(), by_jet));
  }

  // Relative to the oracle's row; absolute if that row is zero.
  double RowError(int row, int first_column, int columns) const {
    const double size = jet_J_.row(row).template lpNorm<Eigen::Infinity>();
    const double error = (hand_J_.row(row) - jet_J_.row(row))
                             .segment(first_column, columns)
                             .template lpNorm<Eigen::Infinity>();
    return size > 0.0 ? error / size : error;
  }

  Eigen::Matrix<double, Residual::kRows, 1> hand_r_, jet_r_;
  Eigen::Matrix<double, Residual::kRows, 6, Eigen::RowMajor> hand_J_, jet_J_;
};

// Whether all types of a TypeList are differentiated by hand.
template <typename... Types>
constexpr bool AllHaveJacobians(TypeList<Types...>) {
  return (kHas<JacobianOf, Types> && ...);
}

// A TypeList for TYPED_TEST_SUITE; CostName names its tests after the costs.
template <typename List>
struct AsGTestTypes;
template <typename... Types>
struct AsGTestTypes<TypeList<Types...>> {
  using type = ::testing::Types<Types...>;
};
struct CostName {
  template <typename Residual>
  static std::string GetName(int /*index*/) {
    return Residual::kName;
  }
};

}  // namespace rgbd_pose
