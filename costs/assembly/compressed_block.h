#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

// One Ceres residual block that represents a whole sum of robustified ones.
//
// For a Gauss-Newton step over N blocks Ceres needs only their sums
//
//   c = 1/2 sum rho(|r_i|^2),  g = sum rho' J_i^T r_i,  H = sum rho' J_i^T J_i,
//
// so one block with K + 1 rows is enough (docs/compressed_block.md):
//
//   r = [ L^-1 g ; sqrt(2 c - |L^-1 g|^2) ],  J = [ L^T ; 0 ],  H = L L^T.
//
// This header depends on nothing else in the project.

namespace rgbd_pose {

// A Jacobian as Ceres stores it. In Eigen a single column is column-major.
template <int Rows, int K>
using RowMajor =
    Eigen::Matrix<double, Rows, K, K == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

// The three sums H, g and c at one x[K].
template <int K>
struct CompressedSums {
  // H, a symmetric matrix.
  Eigen::Matrix<double, K, K> hessian = Eigen::Matrix<double, K, K>::Zero();
  // g.
  Eigen::Matrix<double, K, 1> gradient = Eigen::Matrix<double, K, 1>::Zero();
  double cost = 0.0;  // c
};

namespace compressed {

// Dense sums suit small problems.
inline constexpr int kMostParameters = 18;

// Limits for H scaled to a diagonal of ones. Cholesky pivots below the first
// may be pure rounding; eigenvalues below the second are.
inline constexpr double kSafePivot = 1e-6;
inline constexpr double kRounding = 2e-14;

// H = L L^T: fills J[K][K] with L^T and r[K] with L^-1 g. Returns false if a
// pivot may be rounding. Loops, as Eigen's Cholesky takes long to compile.
template <int K>
bool FactorRegular(const double* hessian, const double* gradient, double* r,
                   double* J) {
  for (int i = 0; i < K; ++i) {
    double* const row = J + i * K;
    r[i] = gradient[i];
    for (int k = i; k < K; ++k) row[k] = hessian[i * K + k];
    for (int m = 0; m < i; ++m) {
      const double* const above = J + m * K;
      r[i] -= above[i] * r[m];
      for (int k = i; k < K; ++k) row[k] -= above[i] * above[k];
    }
    if (!(row[i] > kSafePivot * hessian[i * K + i])) return false;
    const double root = std::sqrt(row[i]);
    r[i] /= root;
    for (int k = i; k < K; ++k) row[k] /= root;
  }
  return true;
}

// H = D V diag(l) V^T D with some l = 0; D^2 is the diagonal of H, so units do
// not matter. Where l > 0, J = diag(sqrt l) V^T D, r = diag(1/sqrt l) V^T D^-1
// g. In the null space of H, g has no component and the rows are 0, so
// ceres::Covariance sees the rank. Takes H[K][K], g[K], r[K] and J[K][K]. One
// template for all K <= kMost: the solver takes long to compile.
template <int kMost = kMostParameters>
void FactorSingular(int K, const double* hessian, const double* gradient,
                    double* r, double* J) {
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;
  Matrix scaled = Eigen::Map<const Matrix>(hessian, K, K);
  double D[kMost];
  for (int i = 0; i < K; ++i) {
    D[i] = scaled(i, i) > 0.0 ? std::sqrt(scaled(i, i)) : 1.0;
  }
  for (int i = 0; i < K * K; ++i) scaled(i) /= D[i / K] * D[i % K];
  const Eigen::JacobiSVD<Matrix, Eigen::NoQRPreconditioner> svd(
      scaled, Eigen::ComputeFullV);
  for (int i = 0; i < K; ++i) {  // the weakest is last
    const double value = svd.singularValues()[i];
    if (!(value > kRounding * svd.singularValues()[0])) break;
    const double root = std::sqrt(value);
    double along = 0.0;  // the gradient's part in this direction
    for (int k = 0; k < K; ++k) {
      const double direction = svd.matrixV()(k, i);
      J[i * K + k] = root * direction * D[k];
      along += direction / D[k] * gradient[k];
    }
    r[i] = along / root;
  }
}

// Makes |r|^2 smaller by `excess`, to 2 c, for r[K] and J[K][K] of H[K][K].
//
// If H is almost singular, rounding makes |L^-1 g|^2 exceed 2 c. Taking the
// excess out of the last rows, which belong to the weakest directions, hardly
// changes J^T r. Where it would, H is too small for its g and c (under a loss
// that is flat near 0 and then steep, for instance). Then r is divided, and J
// multiplied, by the same factor: g and c are exact, and H grows, so that
// steps are shorter.
inline void TakeExcess(int K, double excess, const double* hessian, double cost,
                       double* r, double* J) {
  constexpr double kSameGradient = 1e-6;  // relative, in units of D
  double left = excess, off = 0.0, whole = 0.0, square = 0.0;
  for (int k = 0; k < K; ++k) square += r[k] * r[k];
  double trimmed[kMostParameters];
  for (int i = K - 1; i >= 0; --i) {
    const double rest = std::max(0.0, r[i] * r[i] - std::max(0.0, left));
    trimmed[i] = std::copysign(std::sqrt(rest), r[i]);
    left -= r[i] * r[i];
  }
  for (int k = 0; k < K; ++k) {
    if (!(hessian[k * K + k] > 0.0)) continue;
    double change = 0.0, gradient = 0.0;
    for (int i = 0; i < K; ++i) {
      change += J[i * K + k] * (r[i] - trimmed[i]);
      gradient += J[i * K + k] * r[i];
    }
    off += change * change / hessian[k * K + k];
    whole += gradient * gradient / hessian[k * K + k];
  }
  if (!(cost > 0.0) || off <= kSameGradient * kSameGradient * whole) {
    std::copy(trimmed, trimmed + K, r);
    return;
  }
  const double factor = std::sqrt(square / (2.0 * cost));
  for (int i = 0; i < K; ++i) r[i] /= factor;
  for (int i = 0; i < K * K; ++i) J[i] *= factor;
}

}  // namespace compressed

// Computes residuals r[K + 1] and the Jacobian J[K + 1][K], row by row, that
// represent the sums. The hessian must be complete, not a triangle. If J is
// null, r represents only the cost, and the other sums are not read. Returns
// false if a number is not finite.
template <int K>
bool FactorSums(const CompressedSums<K>& sums, double* residuals,
                double* jacobian) {
  static_assert(K >= 1 && K <= compressed::kMostParameters);
  if (!std::isfinite(sums.cost)) return false;
  Eigen::Map<Eigen::Matrix<double, K + 1, 1>> r(residuals);
  r.setZero();
  r[K] = std::sqrt(std::max(0.0, 2.0 * sums.cost));
  if (jacobian == nullptr) return true;
  if (!sums.gradient.allFinite() || !sums.hessian.allFinite()) return false;
  Eigen::Map<RowMajor<K + 1, K>> J(jacobian);
  J.setZero();
  if (!compressed::FactorRegular<K>(sums.hessian.data(), sums.gradient.data(),
                                    residuals, jacobian)) {
    r.template head<K>().setZero();
    J.setZero();
    compressed::FactorSingular(K, sums.hessian.data(), sums.gradient.data(),
                               residuals, jacobian);
  }
  const double rest = 2.0 * sums.cost - r.template head<K>().squaredNorm();
  r[K] = std::sqrt(std::max(0.0, rest));
  if (rest < 0.0) {
    compressed::TakeExcess(K, -rest, sums.hessian.data(), sums.cost, residuals,
                           jacobian);
  }
  return r.allFinite() && J.allFinite();
}

// `Evaluator` is called as
//
//   bool(const double* x, bool with_derivatives, CompressedSums<K>* sums) const
//
// with x[K] and zeroed sums. It fills in the cost and, with derivatives, the
// other sums; false makes Ceres reject the step. The block stores nothing
// between calls and is as thread-safe as its evaluator.
template <int K, typename Evaluator>
class CompressedBlock final : public ceres::SizedCostFunction<K + 1, K> {
 public:
  // Takes a copy of the evaluator.
  explicit CompressedBlock(Evaluator evaluator)
      : evaluator_(std::move(evaluator)) {}

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

}  // namespace rgbd_pose
