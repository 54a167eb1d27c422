#pragma once

#include <ceres/crs_matrix.h>
#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "core/estimation/motion_cost.h"

namespace rgbd_pose {

// The residual blocks of a cost as passed to Ceres.
inline std::unique_ptr<ceres::Problem> BuildProblem(
    MotionCost* cost, Assembly assembly, const LinearizationPoint& origin,
    ceres::LossFunction* loss, double* x) {
  ceres::Problem::Options options;
  options.cost_function_ownership = BlockOwnership(assembly);
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  auto problem = std::make_unique<ceres::Problem>(options);
  cost->AddTo(assembly, origin, loss, x, problem.get());
  return problem;
}

// The normal equations that Ceres evaluates at x.
inline NormalEquations EvaluateProblem(MotionCost* cost, Assembly assembly,
                                       const LinearizationPoint& origin,
                                       ceres::LossFunction* loss,
                                       MotionVector x) {
  const auto problem = BuildProblem(cost, assembly, origin, loss, x.data());
  NormalEquations result;
  std::vector<double> gradient;
  ceres::CRSMatrix crs;
  problem->Evaluate({}, &result.cost, nullptr, &gradient, &crs);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(crs.num_rows, 6);
  for (int row = 0; row < crs.num_rows; ++row) {
    for (int k = crs.rows[row]; k < crs.rows[row + 1]; ++k) {
      J(row, crs.cols[k]) = crs.values[k];
    }
  }
  result.hessian = J.transpose() * J;
  result.gradient = Eigen::Map<MotionVector>(gradient.data());
  return result;
}

}  // namespace rgbd_pose
