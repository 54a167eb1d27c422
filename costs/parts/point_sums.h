#pragma once

#include <Eigen/Core>
#include <type_traits>

#include "core/estimation/motion_cost.h"
#include "core/geometry/motion.h"

// A shortcut for residuals that depend on the motion through one moved point:
// r = f(q), A = dr/dq. A small rotation omega and a shift c of q give
//
//   dq = omega x q + c.
//
// With N = A^T A and n = A^T r (3 numbers) the normal equations in (omega, c)
// are sums of N, N [q]x, [q]x^T N [q]x, n and n x q: 27 sums for any number of
// rows instead of 27 for each row. How omega and c depend on the six parameters
// is the same for all matches and is applied once, at the end.

namespace rgbd_pose {

// Whether Type has the optional member that the alias Member<Type> names.
template <template <typename> typename Member, typename Type, typename = void>
constexpr bool kHas = false;
template <template <typename> typename Member, typename Type>
constexpr bool kHas<Member, Type, std::void_t<Member<Type>>> = true;

// The contribution of one match.
template <typename D>
struct PointTerm {
  D q[3];    // the moved point
  D JtJ[6];  // N: 00 01 02 11 12 22
  D Jtr[3];  // n
};

template <typename D>
double LaneSum(const D& lanes) {
  constexpr int kLanes = sizeof(D) / sizeof(double);
  double total = 0.0;
  for (int lane = 0; lane < kLanes; ++lane) total += lanes[lane];
  return total;
}

// An N x N matrix from the sums of its upper triangle, row by row.
template <int N, typename D>
Eigen::Matrix<double, N, N> SymmetricLaneSums(const D* entries) {
  Eigen::Matrix<double, N, N> matrix;
  for (int i = 0; i < N; ++i) {
    for (int k = i; k < N; ++k) {
      matrix(i, k) = matrix(k, i) = LaneSum(*entries++);
    }
  }
  return matrix;
}

// The sums over all matches, lane by lane.
template <typename D>
class PointSums {
 public:
  void Add(const PointTerm<D>& term, const D& weight) {
    const D* q = term.q;
    D N[6], n[3];
    for (int i = 0; i < 6; ++i) N[i] = weight * term.JtJ[i];
    for (int i = 0; i < 3; ++i) n[i] = weight * term.Jtr[i];
    // P = N [q]x: row i is (row i of N) x q.
    const D P[3][3] = {{N[1] * q[2] - N[2] * q[1], N[2] * q[0] - N[0] * q[2],
                        N[0] * q[1] - N[1] * q[0]},
                       {N[3] * q[2] - N[4] * q[1], N[4] * q[0] - N[1] * q[2],
                        N[1] * q[1] - N[3] * q[0]},
                       {N[4] * q[2] - N[5] * q[1], N[5] * q[0] - N[2] * q[2],
                        N[2] * q[1] - N[4] * q[0]}};
    for (int i = 0; i < 6; ++i) shift_shift_[i] += N[i];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) shift_turn_[i][k] += P[i][k];
    }
    // [q]x^T P: column k is (column k of P) x q.
    turn_turn_[0] += P[1][0] * q[2] - P[2][0] * q[1];
    turn_turn_[1] += P[1][1] * q[2] - P[2][1] * q[1];
    turn_turn_[2] += P[1][2] * q[2] - P[2][2] * q[1];
    turn_turn_[3] += P[2][1] * q[0] - P[0][1] * q[2];
    turn_turn_[4] += P[2][2] * q[0] - P[0][2] * q[2];
    turn_turn_[5] += P[0][2] * q[1] - P[1][2] * q[0];
    for (int i = 0; i < 3; ++i) shift_[i] += n[i];
    turn_[0] += n[1] * q[2] - n[2] * q[1];
    turn_[1] += n[2] * q[0] - n[0] * q[2];
    turn_[2] += n[0] * q[1] - n[1] * q[0];
  }

  // Adds the normal equations in the six parameters: omega = turn * d(angles),
  // c = shift * dC.
  void AddTo(const Eigen::Matrix3d& turn, const Eigen::Matrix3d& shift,
             NormalEquations* sum) const {
    // In (omega, c); the signs are those of dq = [q]x^T omega + c.
    Eigen::Matrix3d shift_turn;
    Eigen::Vector3d g_turn, g_shift;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k)
        shift_turn(i, k) = -LaneSum(shift_turn_[i][k]);
      g_turn[i] = -LaneSum(turn_[i]);
      g_shift[i] = LaneSum(shift_[i]);
    }
    const Eigen::Matrix3d corner = shift.transpose() * shift_turn * turn;
    MotionMatrix& hessian = sum->hessian;
    hessian.topLeftCorner<3, 3>() +=
        turn.transpose() * SymmetricLaneSums<3>(turn_turn_) * turn;
    hessian.bottomRightCorner<3, 3>() +=
        shift.transpose() * SymmetricLaneSums<3>(shift_shift_) * shift;
    hessian.bottomLeftCorner<3, 3>() += corner;
    hessian.topRightCorner<3, 3>() += corner.transpose();
    sum->gradient.head<3>() += turn.transpose() * g_turn;
    sum->gradient.tail<3>() += shift.transpose() * g_shift;
  }

 private:
  D turn_turn_[6] = {};
  D shift_turn_[3][3] = {};
  D shift_shift_[6] = {};
  D turn_[3] = {};
  D shift_[3] = {};
};

// Detects a residual type's optional point terms: kPointTerms = 1 for the
// forward point R (X_prev - C), 2 to add the backward point R^T X_cur + C, and
//   PointTerms(motion, columns, terms).
template <typename Residual>
using PointTermsOf = decltype(Residual::kPointTerms);

}  // namespace rgbd_pose
