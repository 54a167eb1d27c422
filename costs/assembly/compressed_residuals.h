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
// other. Returning false rejects the step, as in Ceres.

namespace rgbd_pose {

// The sums over all residuals under one loss (null: none). Exactly what Ceres
// makes of one block a residual where rho'' <= 0, as for all losses of Ceres
// and of this project; a loss with rho'' > 0 would be weighted by rho' alone.
// Time and memory are linear in the number of residuals; nothing is allocated.
template <typename Residual>
class CompressedResiduals {
 public:
  // The number of parameters.
  static constexpr int K = Residual::kParameters;

  // Both must outlive this.
  CompressedResiduals(const std::vector<Residual>* residuals,
                      const ceres::LossFunction* loss)
      : residuals_(residuals), loss_(loss) {}

  bool operator()(const double* x, CompressedSums<K>* sums) const {
    constexpr int kRows = Residual::kRows;
    Eigen::Matrix<double, kRows, 1> r;
    // Eigen stores a single column only column by column.
    Eigen::Matrix<double, kRows, K, K == 1 ? Eigen::ColMajor : Eigen::RowMajor>
        J;
    for (const Residual& residual : *residuals_) {
      if (!residual(x, r.data(), J.data())) return false;
      double rho[3] = {r.squaredNorm(), 1.0, 0.0};
      if (loss_ != nullptr) loss_->Evaluate(r.squaredNorm(), rho);
      sums->cost += 0.5 * rho[0];
      sums->gradient.noalias() += rho[1] * (J.transpose() * r);
      sums->hessian.noalias() += rho[1] * (J.transpose() * J);
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
