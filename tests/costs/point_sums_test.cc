#include "costs/parts/point_sums.h"

#include <gtest/gtest.h>

#include "core/util/vector_lanes.h"

namespace rgbd_pose {
namespace {

constexpr double kRounding = 1e-12;  // sums of 12 numbers near 1
constexpr int kLanes = 4;
constexpr int kAdditions = 3;
using D = Lanes<kLanes>::Type;

Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d skew;
  skew << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return skew;
}

// The normal equations of points that move by dq = [q]x^T omega + c, without
// zeros that could hide a wrong entry.
TEST(PointSumsTest, AreTheNormalEquationsOfMovedPoints) {
  Eigen::Matrix3d turn, shift;
  turn << 0.9, 0.2, -0.3, 0.1, 1.1, 0.4, -0.2, 0.3, 0.8;
  shift << 1.2, -0.1, 0.2, 0.3, 0.7, -0.4, 0.5, 0.1, 0.9;
  PointSums<D> sums;
  MotionMatrix hessian = MotionMatrix::Zero();
  MotionVector gradient = MotionVector::Zero();
  for (int addition = 0; addition < kAdditions; ++addition) {
    PointTerm<D> term;
    D weight;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int i = kLanes * addition + lane;
      // Reproducible numbers without a pattern.
      const auto number = [&](int k) {
        return std::sin(1.0 + 7.0 * i + 3 * k);
      };
      const Eigen::Vector3d q(number(0), number(1), number(2));
      const Eigen::Vector3d n(number(3), number(4), number(5));
      Eigen::Matrix3d N;
      for (int row = 0, entry = 0; row < 3; ++row) {
        for (int column = row; column < 3; ++column, ++entry) {
          N(row, column) = N(column, row) = number(6 + entry);
          term.JtJ[entry][lane] = number(6 + entry);
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        term.q[axis][lane] = q[axis];
        term.Jtr[axis][lane] = n[axis];
      }
      weight[lane] = 0.5 + 0.1 * i;
      Eigen::Matrix<double, 3, 6> J;
      J << Skew(q).transpose() * turn, shift;
      hessian += weight[lane] * J.transpose() * N * J;
      gradient += weight[lane] * J.transpose() * n;
    }
    sums.Add(term, weight);
  }
  NormalEquations sum;
  sums.AddTo(turn, shift, &sum);
  EXPECT_LT((sum.hessian - hessian).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_LT((sum.gradient - gradient).cwiseAbs().maxCoeff(), kRounding);
}

}  // namespace
}  // namespace rgbd_pose
