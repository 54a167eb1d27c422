#include "core/pose_graph/sparse_inverse.h"

#include <algorithm>
#include <vector>

namespace rgbd_pose {
namespace {

// Pivots that are smaller, relative to the diagonal, are due to rounding.
constexpr double kMinPivot = 1e-13;

}  // namespace

Eigen::SparseMatrix<double> InformationOf(const ceres::CRSMatrix& jacobian) {
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
  const Eigen::Map<const Sparse> J(jacobian.num_rows, jacobian.num_cols,
                                   static_cast<int>(jacobian.values.size()),
                                   jacobian.rows.data(), jacobian.cols.data(),
                                   jacobian.values.data());
  return J.transpose() * J;
}

SparseInverse::SparseInverse(const Eigen::SparseMatrix<double>& matrix)
    : ldlt_(matrix) {
  if (ldlt_.info() != Eigen::Success) return;
  diagonal_ = ldlt_.permutationP() * Eigen::VectorXd(matrix.diagonal());
  const Eigen::VectorXd pivots = ldlt_.vectorD();
  is_valid_ = (pivots.array() > kMinPivot * diagonal_.array()).all();
  if (!is_valid_) return;
  below_ = ldlt_.matrixL().nestedExpression();
  const int* const begin = below_.outerIndexPtr();
  const int* const row = below_.innerIndexPtr();
  double* const value = below_.valuePtr();
  // Where the rows of column j are among its entries; -1 for other rows.
  std::vector<int> place(below_.rows(), -1);
  std::vector<double> sum;  // of Z_ik L_kj over k, by place of i
  for (int j = static_cast<int>(below_.cols()) - 1; j >= 0; --j) {
    const int first = begin[j], entries = begin[j + 1] - first;
    const double* const L = value + first;
    for (int k = 0; k < entries; ++k) place[row[first + k]] = k;
    sum.assign(entries, 0.0);
    for (int k = 0; k < entries; ++k) {
      const int col = row[first + k];
      double total = diagonal_[col] * L[k];
      for (int e = begin[col]; e < begin[col + 1]; ++e) {
        const int i = place[row[e]];
        if (i < 0) continue;
        sum[i] += value[e] * L[k];
        total += value[e] * L[i];
      }
      sum[k] += total;
    }
    diagonal_[j] = 1.0 / pivots[j];
    for (int k = 0; k < entries; ++k) {
      diagonal_[j] += sum[k] * L[k];
      place[row[first + k]] = -1;
    }
    for (int k = 0; k < entries; ++k) value[first + k] = -sum[k];
  }
}

double SparseInverse::operator()(int row, int col) const {
  const auto& place = ldlt_.permutationP().indices();
  int i = place[row], j = place[col];
  if (i == j) return diagonal_[i];
  if (i < j) std::swap(i, j);
  return below_.coeff(i, j);
}

Eigen::VectorXd SparseInverse::Column(int col) const {
  return ldlt_.solve(Eigen::VectorXd::Unit(ldlt_.rows(), col));
}

}  // namespace rgbd_pose
