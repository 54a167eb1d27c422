#pragma once

#include <ceres/crs_matrix.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace rgbd_pose {

// J^T J of a Jacobian that Ceres has evaluated.
Eigen::SparseMatrix<double> InformationOf(const ceres::CRSMatrix& jacobian);

// The inverse of a sparse, symmetric, positive definite matrix, but only where
// its Cholesky factor has entries, and so wherever the matrix itself has: as
// much work as about two factorisations, where a whole inverse is dense.
//
// With P A P^T = L D L^T and Z = A^-1, permuted, Z L = L^-T D^-1 gives the
// columns of Z from the last to the first (Takahashi, Fagan and Chen 1973):
//
//   Z_ij = [i = j] / D_j - sum over k > j of Z_ik L_kj
class SparseInverse {
 public:
  // Only the lower triangle of the matrix is read.
  explicit SparseInverse(const Eigen::SparseMatrix<double>& matrix);

  // Whether the matrix is positive definite beyond rounding. If not, no entry
  // may be read.
  bool is_valid() const { return is_valid_; }

  // An entry of the inverse, at a row and column where the matrix has one.
  double operator()(int row, int col) const;

  // A column of the inverse with all its entries, each time by one solve.
  Eigen::VectorXd Column(int col) const;

 private:
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt_;
  bool is_valid_ = false;
  Eigen::SparseMatrix<double> below_;  // Z below its diagonal, where L has it
  Eigen::VectorXd diagonal_;           // of Z
};

}  // namespace rgbd_pose
