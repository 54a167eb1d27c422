#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
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
// it takes with N blocks. The sums are those for losses with rho'' <= 0; where
// rho'' > 0 Ceres adds sum 2 rho'' J_i^T r_i r_i^T J_i to H. This header needs
// nothing else of the project.

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
// alone and the other sums are not read. False if a number is not finite.
template <int K>
bool FactorSums(const CompressedSums<K>& sums, double* residuals,
                double* jacobian);

// `Evaluator` is called as
//
//   bool(const double* x, bool with_derivatives, CompressedSums<K>* sums) const
//
// with x[K] and zeroed sums; it fills the cost and, if asked for derivatives,
// the rest. False makes Ceres reject the step. The block keeps nothing between
// calls: losses and data may change between two solves, as in plain Ceres, and
// it serves as many threads as its evaluator.
template <int K, typename Evaluator>
class CompressedBlock final : public ceres::SizedCostFunction<K + 1, K> {
  static_assert(K >= 1 && K <= 12, "dense sums suit small problems");

 public:
  // Keeps the evaluator.
  explicit CompressedBlock(Evaluator evaluator)
      : evaluator_(std::move(evaluator)) {}

  // The K + 1 rows, as Ceres asks for them.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    double* const jacobian = jacobians != nullptr ? jacobians[0] : nullptr;
    CompressedSums<K> sums;
    return evaluator_(parameters[0], jacobian != nullptr, &sums) &&
           FactorSums(sums, residuals, jacobian);
  }

 private:
  Evaluator evaluator_;
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

// A Hessian to be factored. Of more parameters than a motion has Eigen would
// unroll loops for half a minute of compiling; nothing is allocated either way.
template <int K>
using Factorable = Eigen::Matrix<double, K <= 6 ? K : Eigen::Dynamic,
                                 K <= 6 ? K : Eigen::Dynamic, 0, K, K>;

// Of H scaled to a diagonal of ones: below the first Cholesky's pivots may be
// rounding alone, below the second eigenvalues are.
inline constexpr double kSafePivot = 1e-6;
inline constexpr double kRounding = 2e-14;

// H = D V diag(l) V^T D, D^2 the diagonal of H so that units do not matter,
// with some l = 0: J = diag(sqrt l) V^T D, r = diag(1/sqrt l) V^T D^-1 g where
// l > 0. g has no part in the null space of H, whose rows are 0:
// ceres::Covariance sees the rank.
template <int K, typename Residuals, typename Rows>
void FactorSingular(const CompressedSums<K>& sums, Residuals r, Rows J) {
  const Eigen::Matrix<double, K, 1> D = sums.hessian.diagonal().unaryExpr(
      [](double square) { return square > 0.0 ? std::sqrt(square) : 1.0; });
  const auto inverse = D.cwiseInverse().eval();
  const Factorable<K> scaled =
      inverse.asDiagonal() * sums.hessian * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Factorable<K>> eigen(scaled);
  const double smallest =
      kRounding * std::max(0.0, eigen.eigenvalues().maxCoeff());
  for (int i = 0; i < K; ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > smallest)) continue;
    const double root = std::sqrt(value);
    const int row = K - 1 - i;  // the weakest last
    const Eigen::Matrix<double, K, 1> direction = eigen.eigenvectors().col(i);
    J.row(row) = root * direction.cwiseProduct(D).transpose();
    r[row] = direction.dot(inverse.cwiseProduct(sums.gradient)) / root;
  }
}

}  // namespace compressed

template <int K>
bool FactorSums(const CompressedSums<K>& sums, double* residuals,
                double* jacobian) {
  // Row by row, as Ceres has it; Eigen wants a single column by column.
  using RowMajor = Eigen::Matrix<double, K + 1, K,
                                 K == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
  if (!std::isfinite(sums.cost)) return false;
  Eigen::Map<Eigen::Matrix<double, K + 1, 1>> r(residuals);
  r.setZero();
  r[K] = std::sqrt(std::max(0.0, 2.0 * sums.cost));
  if (jacobian == nullptr) return true;
  if (!sums.gradient.allFinite() || !sums.hessian.allFinite()) return false;
  Eigen::Map<RowMajor> J(jacobian);
  J.setZero();
  const Eigen::LLT<compressed::Factorable<K>> cholesky(sums.hessian);
  const auto pivots = cholesky.matrixLLT().diagonal().cwiseAbs2();
  if (cholesky.info() == Eigen::Success &&
      (pivots.array() >
       compressed::kSafePivot * sums.hessian.diagonal().array())
          .all()) {
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
