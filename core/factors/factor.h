#pragma once

#include <ceres/autodiff_cost_function.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/factors/blocks.h"

// A factor is a residual over the parameter blocks of any ceres::Problem. It is
// a type that defines (example: core/factors/relative_pose.h)
//
//     static constexpr char kName[];
//     using Blocks = BlockList<PoseBlock, PoseBlock>;   its blocks, in order
//     static constexpr int kRows;                       of the residual
//     template <typename T>
//     bool Residual(const PoseOf<T>& a, const PoseOf<T>& b, T* r) const;
//     bool Jacobian(const PoseOf<double>& a, const PoseOf<double>& b,
//                   double* r, TangentJacobian<kRows, PoseBlock>* by_a,
//                   TangentJacobian<kRows, PoseBlock>* by_b) const;
//
// Residuals are whitened: one sigma is 1. Jacobian fills in r, too, and is by
// hand, in the tangent (core/factors/blocks.h); a factor without it is
// differentiated automatically. False rejects the step, as in Ceres. To be in
// FactorTypes (costs/factors/factor_list.cc) it also has
//
//     static Factor Sample(FactorSampler* random);   random measurements
//     static std::vector<std::vector<double>> Near();
//
// Near is for a factor that cannot be evaluated just anywhere: blocks near
// which it can.

namespace rgbd_pose {
namespace factors {

template <typename Factor, typename Blocks = typename Factor::Blocks>
class AnalyticFunction;

template <typename Factor, typename... B>
class AnalyticFunction<Factor, BlockList<B...>> final
    : public ceres::SizedCostFunction<Factor::kRows, B::kSize...> {
 public:
  explicit AnalyticFunction(Factor factor) : factor_(std::move(factor)) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    return Evaluate(parameters, residuals, jacobians,
                    std::index_sequence_for<B...>());
  }

 private:
  template <size_t... I>
  bool Evaluate(double const* const* x, double* r, double** jacobians,
                std::index_sequence<I...> /*blocks*/) const {
    if (jacobians == nullptr) {
      return factor_.Residual(B::Read(x[I])..., r) && HasCost(r);
    }
    std::tuple<TangentJacobian<Factor::kRows, B>...> by;
    if (!factor_.Jacobian(B::Read(x[I])..., r, &std::get<I>(by)...) ||
        !HasCost(r)) {
      return false;
    }
    const auto lift = [&](auto block, const auto& by_block, size_t i) {
      if (jacobians[i] == nullptr) return;
      decltype(block)::template Lift<Factor::kRows>(by_block, x[i],
                                                    jacobians[i]);
    };
    (lift(B(), std::get<I>(by), I), ...);
    return true;
  }

  // Where the cost is infinite, Ceres 2.2 would write to stderr.
  static bool HasCost(const double* r) {
    return std::isfinite(
        Eigen::Map<const Eigen::Matrix<double, Factor::kRows, 1>>(r)
            .squaredNorm());
  }

  const Factor factor_;
};

template <typename Factor, typename Blocks = typename Factor::Blocks>
struct AutodiffFunction;

template <typename Factor, typename... B>
struct AutodiffFunction<Factor, BlockList<B...>> {
  template <typename T, typename /*Block*/>
  using Numbers = const T*;

  template <typename T>
  bool operator()(Numbers<T, B>... x, T* r) const {
    return factor.Residual(B::Read(x)..., r);
  }

  using Type =
      ceres::AutoDiffCostFunction<AutodiffFunction, Factor::kRows, B::kSize...>;

  Factor factor;
};

// Detects a Jacobian by hand.
template <typename Factor, typename = void>
constexpr bool kHasJacobian = false;
template <typename Factor>
constexpr bool kHasJacobian<Factor, std::void_t<decltype(&Factor::Jacobian)>> =
    true;

}  // namespace factors

// A factor with automatic derivatives: the oracle of its hand-written ones.
template <typename Factor>
ceres::CostFunction* MakeAutodiffFactor(Factor factor) {
  using Function = factors::AutodiffFunction<Factor>;
  return new typename Function::Type(new Function{std::move(factor)});
}

// A factor as a cost function, to be owned by a ceres::Problem.
template <typename Factor>
ceres::CostFunction* MakeFactor(Factor factor) {
  if constexpr (factors::kHasJacobian<Factor>) {
    return new factors::AnalyticFunction<Factor>(std::move(factor));
  } else {
    return MakeAutodiffFactor(std::move(factor));
  }
}

}  // namespace rgbd_pose
