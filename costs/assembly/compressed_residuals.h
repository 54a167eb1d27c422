#pragma once

#include <ceres/loss_function.h>

#include <vector>

#include "costs/assembly/compressed_block.h"

// Many residuals of one type as one Ceres block: compressed_block.h for those
// who have a residual and its Jacobian and do not want to write the sums. Needs
// nothing else of the project; docs/compressed_block.md has an example.
//
// A residual type says its sizes and evaluates itself:
//
//   static constexpr int kRows, kParameters;            (kParameters <= 12)
//   bool operator()(const double* x, double* r, double* J) const;
//
// with x[kParameters], r[kRows] and J[kRows * kParameters], a row after the
// other; J is null where only residuals are asked for. Returning false, or a
// number that is not finite, rejects the step, as in Ceres.

namespace rgbd_pose {

// The sums over all residuals under one loss (null: none): exactly what Ceres
// makes of one block a residual, whatever the sign of rho''. Time and memory
// are linear in the number of residuals; nothing is allocated.
template <typename Residual>
class CompressedResiduals {
 public:
  // The number of parameters.
  static constexpr int K = Residual::kParameters;

  // Both must outlive this.
  CompressedResiduals(const std::vector<Residual>* residuals,
                      const ceres::LossFunction* loss)
      : residuals_(residuals), loss_(loss) {}

  bool operator()(const double* x, bool with_derivatives,
                  CompressedSums<K>* sums) const {
    constexpr int kRows = Residual::kRows;
    Eigen::Matrix<double, kRows, 1> r;
    // Eigen stores a single column only column by column.
    Eigen::Matrix<double, kRows, K, K == 1 ? Eigen::ColMajor : Eigen::RowMajor>
        J;
    double* const derivatives = with_derivatives ? J.data() : nullptr;
    for (const Residual& residual : *residuals_) {
      // A loss may take what is not finite for an outlier.
      if (!residual(x, r.data(), derivatives) || !r.allFinite()) return false;
      double rho[3] = {r.squaredNorm(), 1.0, 0.0};
      if (loss_ != nullptr) loss_->Evaluate(r.squaredNorm(), rho);
      sums->cost += 0.5 * rho[0];
      if (!with_derivatives) continue;
      const Eigen::Matrix<double, K, 1> g = J.transpose() * r;
      sums->gradient += rho[1] * g;
      sums->hessian.noalias() += rho[1] * (J.transpose() * J);
      if (rho[2] > 0.0) sums->hessian += 2.0 * rho[2] * (g * g.transpose());
    }
    return true;
  }

 private:
  const std::vector<Residual>* residuals_;
  const ceres::LossFunction* loss_;
};

// The block itself, for a ceres::Problem to own. Add it without a loss: that is
// inside already.
template <typename Residual>
ceres::CostFunction* MakeCompressedBlock(
    const std::vector<Residual>* residuals,
    const ceres::LossFunction* loss = nullptr) {
  using Sums = CompressedResiduals<Residual>;
  return new CompressedBlock<Residual::kParameters, Sums>(
      Sums(residuals, loss));
}

}  // namespace rgbd_pose
