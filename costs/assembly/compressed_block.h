#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// One Ceres residual block that stands for a whole sum of robustified ones.
//
// Ceres spends most of its time around small residual blocks rather than in
// them. A Gauss-Newton step needs of N blocks only their sums
//
//   c = 1/2 sum rho(|r_i|^2),  g = sum rho' J_i^T r_i,  H = sum rho' J_i^T J_i,
//
// so one block with K + 1 rows is enough:
//
//   r = [ L^-1 g ; sqrt(2 c - |L^-1 g|^2) ],  J = [ L^T ; 0 ],  H = L L^T,
//
// since r^T r / 2 = c, J^T r = g and J^T J = H: Ceres takes the very steps that
// it takes with N blocks and losses whose rho'' <= 0 (all common ones). This
// header needs nothing else of the project.

namespace rgbd_pose {

// The three sums H, g and c at one x[K].
template <int K>
struct CompressedSums {
  // As above.
  Eigen::Matrix<double, K, K> hessian = Eigen::Matrix<double, K, K>::Zero();
  Eigen::Matrix<double, K, 1> gradient = Eigen::Matrix<double, K, 1>::Zero();
  double cost = 0.0;
};

// Residuals r[K + 1] and, row by row, the Jacobian J[K + 1][K] that stand for
// sums whose hessian is whole, not a triangle. Null J: r stands for the cost
// alone. False if a number is not finite.
template <int K>
bool FactorSums(const CompressedSums<K>& sums, double* residuals,
                double* jacobian);

// `Evaluator` is called as bool(const double* x, CompressedSums<K>* sums) with
// x[K] and zeroed sums; it fills all of them. False makes Ceres reject the
// step. Ceres asks for the cost of a trial step first and for its derivatives
// after it has accepted it: the sums of the last x are kept, so both take one
// evaluation. One block serves one thread.
template <int K, typename Evaluator>
class CompressedBlock final : public ceres::SizedCostFunction<K + 1, K> {
  static_assert(K >= 1 && K <= 12, "dense sums suit small problems");

 public:
  // Keeps the evaluator.
  explicit CompressedBlock(Evaluator evaluator)
      : evaluator_(std::move(evaluator)) {
    x_.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  // The K + 1 rows, as Ceres asks for them.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    return UpdateSums(parameters[0]) &&
           FactorSums(sums_, residuals,
                      jacobians != nullptr ? jacobians[0] : nullptr);
  }

 private:
  bool UpdateSums(const double* at) const {
    const Eigen::Map<const Eigen::Matrix<double, K, 1>> x(at);
    if (x == x_) return true;
    x_.setConstant(std::numeric_limits<double>::quiet_NaN());
    sums_ = CompressedSums<K>();
    if (!evaluator_(at, &sums_)) return false;
    x_ = x;
    return true;
  }

  Evaluator evaluator_;
  mutable Eigen::Matrix<double, K, 1> x_;  // of sums_; NaN: of none
  mutable CompressedSums<K> sums_;
};

namespace compressed {

// Where H is all but singular, rounding lets |L^-1 g|^2 exceed 2 c. Takes the
// excess out of the last rows: they belong to the weakest directions, so that
// the cost becomes exact and J^T r hardly changes.
template <int K, typename Residuals>
void Trim(double excess, Residuals r) {
  for (int i = K - 1; i >= 0 && excess > 0.0; --i) {
    const double square = r[i] * r[i];
    r[i] = std::copysign(std::sqrt(std::max(0.0, square - excess)), r[i]);
    excess -= square;
  }
}

// H = V diag(l) V^T with some l = 0: J = diag(sqrt l) V^T, r = diag(1/sqrt l)
// V^T g where l > 0. There g has no part in the null space of H.
template <int K, typename Residuals, typename Rows>
void FactorSingular(const CompressedSums<K>& sums, Residuals r, Rows J) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, K, K>> eigen(
      sums.hessian);
  const double smallest = 1e-14 * std::max(0.0, eigen.eigenvalues().maxCoeff());
  for (int i = 0; i < K; ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > smallest)) continue;
    const double root = std::sqrt(value);
    const int row = K - 1 - i;  // the weakest last
    J.row(row) = root * eigen.eigenvectors().col(i).transpose();
    r[row] = eigen.eigenvectors().col(i).dot(sums.gradient) / root;
  }
}

}  // namespace compressed

template <int K>
bool FactorSums(const CompressedSums<K>& sums, double* residuals,
                double* jacobian) {
  // Row by row, as Ceres has it; Eigen wants a single column by column.
  using RowMajor = Eigen::Matrix<double, K + 1, K,
                                 K == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
  Eigen::Map<Eigen::Matrix<double, K + 1, 1>> r(residuals);
  r.setZero();
  r[K] = std::sqrt(std::max(0.0, 2.0 * sums.cost));
  if (jacobian == nullptr) return true;
  Eigen::Map<RowMajor> J(jacobian);
  J.setZero();
  const Eigen::LLT<Eigen::Matrix<double, K, K>> cholesky(sums.hessian);
  if (cholesky.info() == Eigen::Success) {
    r.template head<K>() = cholesky.matrixL().solve(sums.gradient);
    J.template topRows<K>() = cholesky.matrixU();
  } else {
    compressed::FactorSingular<K>(sums, r.template head<K>(),
                                  J.template topRows<K>());
  }
  const double rest = 2.0 * sums.cost - r.template head<K>().squaredNorm();
  r[K] = std::sqrt(std::max(0.0, rest));
  compressed::Trim<K>(-rest, r.template head<K>());
  return r.allFinite() && J.allFinite();
}

}  // namespace rgbd_pose
