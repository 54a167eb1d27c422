#pragma once

#include <ceres/cost_function.h>

#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/factors/check_factor.h"
#include "core/factors/factor.h"

namespace rgbd_pose {

// A cost function for any number of problems and threads. A cost or derivative
// that is not finite fails the evaluation, so Ceres rejects the step instead of
// writing a warning to stderr.
class SharedCostFunction final : public ceres::CostFunction {
 public:
  explicit SharedCostFunction(std::unique_ptr<ceres::CostFunction> function)
      : function_(std::move(function)) {
    set_num_residuals(function_->num_residuals());
    *mutable_parameter_block_sizes() = function_->parameter_block_sizes();
  }

  // Some functions, such as PairFactor, serve one thread at a time.
  std::unique_lock<std::mutex> Lock() const {
    return std::unique_lock<std::mutex>(mutex_);
  }

  bool Evaluate(double const* const* x, double* residuals,
                double** jacobians) const override {
    const auto lock = Lock();
    if (!function_->Evaluate(x, residuals, jacobians)) return false;
    const auto is_finite = [](const double* values, int size) {
      for (int i = 0; i < size; ++i) {
        if (!std::isfinite(values[i])) return false;
      }
      return true;
    };
    const double square = std::inner_product(
        residuals, residuals + num_residuals(), residuals, 0.0);
    if (!std::isfinite(square)) return false;
    if (jacobians == nullptr) return true;
    for (size_t i = 0; i < parameter_block_sizes().size(); ++i) {
      const int size = num_residuals() * parameter_block_sizes()[i];
      if (jacobians[i] != nullptr && !is_finite(jacobians[i], size)) {
        return false;
      }
    }
    return true;
  }

 private:
  const std::unique_ptr<ceres::CostFunction> function_;
  mutable std::mutex mutex_;
};

// A factor of any type, and what a problem has to know of it.
struct AnyFactor {
  std::vector<factors::BlockKind> blocks;

  // Independent residuals, which the default width of a loss depends on. 0: the
  // factor has a loss inside and takes no other.
  int degrees = 0;

  std::shared_ptr<const SharedCostFunction> function;
};

// The kinds of its blocks: "pose, pose".
std::string BlockNames(const AnyFactor& factor);

// Throws InputError, which begins with `where`, for another number of blocks.
void CheckBlockCount(const AnyFactor& factor, const std::string& where,
                     size_t count);

}  // namespace rgbd_pose
