#pragma once

#include <ceres/crs_matrix.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <vector>

#include "robust/m_estimator.h"

namespace rgbd_pose {

// A loss so wide that no weight is 0; null for least squares.
inline std::unique_ptr<ceres::LossFunction> WideLoss(const MEstimator& row,
                                                     int degrees_of_freedom) {
  if (row.make == nullptr) return nullptr;
  return row.make(20.0 * row.Width95(degrees_of_freedom));
}

// Expects that two solves took the same steps, as their costs show.
inline void ExpectSameSteps(const ceres::Solver::Summary& actual,
                            const ceres::Solver::Summary& expected,
                            double tolerance) {
  ASSERT_EQ(actual.iterations.size(), expected.iterations.size());
  for (size_t i = 0; i < expected.iterations.size(); ++i) {
    EXPECT_NEAR(actual.iterations[i].cost, expected.iterations[i].cost,
                tolerance * expected.iterations[i].cost)
        << "iteration " << i;
  }
}

// What a Gauss-Newton step over all blocks of a problem depends on.
struct ProblemSums {
  double cost = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};

// The sums at the problem's state, in the tangents of its blocks.
inline ProblemSums SumsOf(ceres::Problem* problem) {
  ProblemSums sums;
  std::vector<double> gradient;
  ceres::CRSMatrix crs;
  EXPECT_TRUE(problem->Evaluate({}, &sums.cost, nullptr, &gradient, &crs));
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(crs.num_rows, crs.num_cols);
  for (int row = 0; row < crs.num_rows; ++row) {
    for (int k = crs.rows[row]; k < crs.rows[row + 1]; ++k) {
      J(row, crs.cols[k]) = crs.values[k];
    }
  }
  sums.gradient = Eigen::Map<Eigen::VectorXd>(
      gradient.data(), static_cast<Eigen::Index>(gradient.size()));
  sums.hessian = J.transpose() * J;
  return sums;
}

// The largest difference of the sums of two problems, or of two costs
// (NormalEquations); NaN if there is one. It is relative to what the columns of
// the Jacobian allow: a gradient is a sum that cancels.
template <typename Sums>
double SumsError(const Sums& a, const Sums& b) {
  double error = 0.0;
  const auto compare = [&error](double x, double y, double unit) {
    const double off = x == y ? 0.0 : std::abs(x - y) / unit;
    if (!(off <= error)) error = off;
  };
  compare(a.cost, b.cost, b.cost);
  const Eigen::VectorXd size = b.hessian.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < size.size(); ++i) {
    compare(a.gradient[i], b.gradient[i], size[i] * std::sqrt(2.0 * b.cost));
    for (Eigen::Index k = 0; k < size.size(); ++k) {
      compare(a.hessian(i, k), b.hessian(i, k), size[i] * size[k]);
    }
  }
  return error;
}

}  // namespace rgbd_pose
