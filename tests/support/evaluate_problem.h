#pragma once

#include <ceres/problem.h>

#include <memory>

#include "core/estimation/motion_cost.h"
#include "tests/support/problem_sums.h"

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
  const ProblemSums sums =
      SumsOf(BuildProblem(cost, assembly, origin, loss, x.data()).get());
  return {sums.hessian, sums.gradient, sums.cost};
}

}  // namespace rgbd_pose
