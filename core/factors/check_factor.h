#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <memory>
#include <string>
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
  // numbers up to 1.
  std::vector<std::vector<double>> near;
  double spread = 0.1;
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

}  // namespace factors

// Compares the hand-written Jacobian of a factor with automatic differentiation
// and with central differences, and Residual with what Jacobian fills in.
// Empty if they agree at all states. Otherwise a line for each wrong entry says
// its row, block and direction, and the values where they differ most.
template <typename Factor>
std::string CheckFactor(const Factor& factor,
                        const CheckFactorOptions& options = {}) {
  const std::unique_ptr<ceres::CostFunction> by_hand(MakeFactor(factor));
  const std::unique_ptr<ceres::CostFunction> oracle(MakeAutodiffFactor(factor));
  return factors::Check(Factor::kName,
                        factors::KindsOf(typename Factor::Blocks()), *by_hand,
                        *oracle, options);
}

}  // namespace rgbd_pose
