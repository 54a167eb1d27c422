#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <limits>
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
  int samples = 100;  // random states, at least 1
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

// Detects a state at which a factor can be evaluated.
template <typename Factor, typename = void>
constexpr bool kHasNear = false;
template <typename Factor>
constexpr bool kHasNear<Factor, std::void_t<decltype(&Factor::Near)>> = true;

// A factor whose derivatives are NaN until its Jacobian fills them in: left as
// they are in memory, forgotten ones may look right.
template <typename Factor>
struct WithUnsetDerivatives {
  using Blocks = typename Factor::Blocks;
  static constexpr int kRows = Factor::kRows;

  Factor factor;

  template <typename... Arguments>
  bool Residual(const Arguments&... arguments) const {
    return factor.Residual(arguments...);
  }
  template <typename... Arguments>
  bool Jacobian(const Arguments&... arguments) const {
    (Unset(arguments), ...);
    return factor.Jacobian(arguments...);
  }

 private:
  template <typename State>
  static void Unset(const State& /*state or residual*/) {}
  template <int kBlockRows, int kTangent>
  static void Unset(Eigen::Matrix<double, kBlockRows, kTangent>* by_block) {
    by_block->setConstant(std::numeric_limits<double>::quiet_NaN());
  }
};

// MakeFactor for a check.
template <typename Factor>
ceres::CostFunction* MakeFactorToCheck(const Factor& factor) {
  if constexpr (kHasJacobian<Factor>) {
    return new AnalyticFunction<WithUnsetDerivatives<Factor>>({factor});
  } else {
    return MakeFactor(factor);
  }
}

}  // namespace factors

// A factor of any type, as its check sees it.
struct CheckableFactor {
  std::string name;                                  // its kName
  std::vector<factors::BlockKind> kinds;             // of its blocks
  std::unique_ptr<ceres::CostFunction> by_hand;      // as of MakeFactor
  std::unique_ptr<ceres::CostFunction> by_autodiff;  // of MakeAutodiffFactor
  std::vector<std::vector<double>> near;             // see CheckFactorOptions
};

// Makes a factor one that can be checked without its type.
template <typename Factor>
CheckableFactor MakeCheckable(const Factor& factor) {
  CheckableFactor made;
  made.name = Factor::kName;
  made.kinds = factors::KindsOf(typename Factor::Blocks());
  made.by_hand.reset(factors::MakeFactorToCheck(factor));
  made.by_autodiff.reset(MakeAutodiffFactor(factor));
  if constexpr (factors::kHasNear<Factor>) made.near = Factor::Near();
  return made;
}

// Compares the hand-written Jacobian of a factor with automatic differentiation
// and with central differences, and Residual with what Jacobian fills in.
// Empty if they agree at all states. Otherwise a line for each wrong entry says
// its row, block and direction, and the values where they differ most. Where
// Jacobian leaves an entry as it is, all of its row and block are NaN. Throws
// InputError for options, or parts of a CheckableFactor, that do not fit.
std::string CheckFactor(const CheckableFactor& factor,
                        const CheckFactorOptions& options = {});
template <typename Factor>
std::string CheckFactor(const Factor& factor,
                        const CheckFactorOptions& options = {}) {
  return CheckFactor(MakeCheckable(factor), options);
}

// The same as figures: the errors of the Jacobian by each block, in their
// order.
std::vector<FactorErrors> ErrorsOfFactor(
    const CheckableFactor& factor, const CheckFactorOptions& options = {});
template <typename Factor>
std::vector<FactorErrors> ErrorsOfFactor(
    const Factor& factor, const CheckFactorOptions& options = {}) {
  return ErrorsOfFactor(MakeCheckable(factor), options);
}

}  // namespace rgbd_pose
