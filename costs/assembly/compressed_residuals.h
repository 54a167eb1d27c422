#pragma once

#include <ceres/loss_function.h>

#include <vector>

#include "costs/assembly/compressed_block.h"

// Many residuals of one type as one Ceres block, given a residual and its
// Jacobian (example: docs/compressed_block.md). Needs nothing of the project
// but compressed_block.h.
//
// A residual type defines its sizes and evaluates itself:
//
//   static constexpr int kRows, kParameters;            (kParameters <= 18)
//   bool operator()(const double* x, double* r, double* J) const;
//
// with x[kParameters], r[kRows] and J[kRows * kParameters], row by row; J is
// null if only residuals are needed. Returning false or a non-finite number
// rejects the step, as in Ceres. Where sums are taken without CompressedBlock,
// x may be of any type that holds the state.

namespace rgbd_pose {

// The sums over all residuals under one loss (null: none). They equal the sums
// that Ceres forms with one block per residual, whatever the sign of rho''.
// Time and memory are linear in the number of residuals; nothing is allocated.
template <typename Residual>
class CompressedResiduals {
 public:
  // The number of parameters.
  static constexpr int K = Residual::kParameters;

  // Both must outlive this object.
  CompressedResiduals(const std::vector<Residual>* residuals,
                      const ceres::LossFunction* loss)
      : residuals_(residuals), loss_(loss) {}

  // Adds to the sums; `x` is passed on to the residuals.
  template <typename State>
  bool operator()(const State& x, bool with_derivatives,
                  CompressedSums<K>* sums) const {
    constexpr int kRows = Residual::kRows;
    Eigen::Matrix<double, kRows, 1> r;
    RowMajor<kRows, K> J;
    double* const derivatives = with_derivatives ? J.data() : nullptr;
    for (const Residual& residual : *residuals_) {
      // A loss may treat a non-finite residual as an outlier.
      if (!residual(x, r.data(), derivatives) || !r.allFinite()) return false;
      double rho[3] = {r.squaredNorm(), 1.0, 0.0};
      if (loss_ != nullptr) loss_->Evaluate(r.squaredNorm(), rho);
      sums->cost += 0.5 * rho[0];
      if (!with_derivatives) continue;
      const Eigen::Matrix<double, K, 1> g = J.transpose() * r;
      sums->gradient += rho[1] * g;
      // By columns: for large K the whole product takes Eigen twice as long.
      for (int k = 0; k < K; ++k) {
        const Eigen::Matrix<double, kRows, 1> weighted = rho[1] * J.col(k);
        sums->hessian.col(k).noalias() += J.transpose().lazyProduct(weighted);
      }
      if (rho[2] > 0.0) sums->hessian += 2.0 * rho[2] * (g * g.transpose());
    }
    return true;
  }

 private:
  const std::vector<Residual>* residuals_;
  const ceres::LossFunction* loss_;
};

// The block itself, to be owned by a ceres::Problem. Add it without a loss: the
// loss is already inside.
template <typename Residual>
ceres::CostFunction* MakeCompressedBlock(
    const std::vector<Residual>* residuals,
    const ceres::LossFunction* loss = nullptr) {
  using Sums = CompressedResiduals<Residual>;
  return new CompressedBlock<Residual::kParameters, Sums>(
      Sums(residuals, loss));
}

}  // namespace rgbd_pose
