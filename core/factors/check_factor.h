#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "core/factors/blocks.h"
#include "core/factors/factor.h"
#include "core/factors/sampler.h"

namespace rgbd_pose {

// How a factor is checked.
struct CheckFactorOptions {
  int samples = 100;  // random states
  unsigned seed = 1;  // of the states

  // Largest errors, relative to the largest entry of the row: by hand against
  // automatic differentiation, and both against central differences.
  double autodiff_tolerance = 1e-11;
  double difference_tolerance = 1e-6;

  // The blocks of a state, and by how much (rad and units) each direction of
  // the tangents of random states differs from it, for factors that cannot be
  // evaluated just anywhere. Empty: any rotation, positions up to 2 m, other
  // numbers up to 1; or near Factor::Near(), if there is one.
  std::vector<std::vector<double>> near;
  double spread = 0.1;
};

// The largest errors of a Jacobian by one block over random states, relative to
// the largest entry of the row. NaN if a state cannot be evaluated.
struct FactorErrors {
  std::string block;         // the name of its type
  double autodiff = 0.0;     // by hand against automatic differentiation
  double differences = 0.0;  // by hand against central differences
};

namespace factors {

// The functions of one type of block.
struct BlockKind {
  const char* name;
  int size;
  int tangent;
  Eigen::MatrixXd (*plus_jacobian)(const double* x);
  void (*plus)(const double* x, const double* d, double* moved);
  std::string (*name_of)(int tangent);
  Eigen::VectorXd (*random)(FactorSampler* random);
};

template <typename... B>
std::vector<BlockKind> KindsOf(BlockList<B...> /*blocks*/) {
  return {
      {B::kName, B::kSize, B::kTangent,
       [](const double* x) -> Eigen::MatrixXd { return B::PlusJacobian(x); },
       B::Plus, B::NameOf,
       [](FactorSampler* random) -> Eigen::VectorXd {
         return B::Random(random);
       }}...};
}

std::string Check(const std::string& name, const std::vector<BlockKind>& kinds,
                  const ceres::CostFunction& by_hand,
                  const ceres::CostFunction& by_autodiff,
                  const CheckFactorOptions& options);

std::vector<FactorErrors> Errors(const std::string& name,
                                 const std::vector<BlockKind>& kinds,
                                 const ceres::CostFunction& by_hand,
                                 const ceres::CostFunction& by_autodiff,
                                 const CheckFactorOptions& options);

// Detects a state at which a factor can be evaluated.
template <typename Factor, typename = void>
constexpr bool kHasNear = false;
template <typename Factor>
constexpr bool kHasNear<Factor, std::void_t<decltype(&Factor::Near)>> = true;

// Calls check(name, kinds, by_hand, by_autodiff, options).
template <typename Factor, typename Check>
auto With(const Factor& factor, CheckFactorOptions options, Check check) {
  if constexpr (kHasNear<Factor>) {
    if (options.near.empty()) options.near = Factor::Near();
  }
  const std::unique_ptr<ceres::CostFunction> by_hand(MakeFactor(factor));
  const std::unique_ptr<ceres::CostFunction> oracle(MakeAutodiffFactor(factor));
  return check(Factor::kName, KindsOf(typename Factor::Blocks()), *by_hand,
               *oracle, options);
}

}  // namespace factors

// Compares the hand-written Jacobian of a factor with automatic differentiation
// and with central differences, and Residual with what Jacobian fills in.
// Empty if they agree at all states. Otherwise a line for each wrong entry says
// its row, block and direction, and the values where they differ most.
template <typename Factor>
std::string CheckFactor(const Factor& factor,
                        const CheckFactorOptions& options = {}) {
  return factors::With(factor, options, factors::Check);
}

// The same as figures: the errors of the Jacobian by each block, in their
// order.
template <typename Factor>
std::vector<FactorErrors> ErrorsOfFactor(
    const Factor& factor, const CheckFactorOptions& options = {}) {
  return factors::With(factor, options, factors::Errors);
}

}  // namespace rgbd_pose
