#pragma once

#include <ceres/loss_function.h>

#include <vector>

#include "core/estimation/cost.h"
#include "core/geometry/motion.h"

namespace rgbd_pose {

// What the covariance of an M-estimate needs of the losses: sums over residual
// blocks of s = |r|^2, p independent rows and weight rho'.
struct LossSums {
  double psi2 = 0.0;      // rho'^2 s
  double weight_p = 0.0;  // rho' p
  double slope_p = 0.0;   // rho' p + 2 s rho''
  double weight = 0.0;    // rho'
  int blocks = 0;

  void Add(const double rho[3], double s, int p) {
    psi2 += rho[1] * rho[1] * s;
    weight_p += rho[1] * p;
    slope_p += rho[1] * p + 2.0 * s * rho[2];
    weight += rho[1];
    ++blocks;
  }
};

// A cost and its loss at its present width (null: least squares).
struct WeightedCost {
  const Cost* cost;
  const ceres::LossFunction* loss;
};

// Sandwich A^-1 B A^-1 of an M-estimate (Huber, Robust Statistics, 6.3). A is
// the weighted Hessian, whose `inverse` is given, times the mean slope of psi
// against its mean weight; B is that Hessian times the mean of psi^2 against
// the mean weight, or, for costs that do not whiten fully, the scatter of their
// matches. Last the usual correction for six fitted parameters.
MotionMatrix RobustCovariance(const std::vector<WeightedCost>& costs,
                              const MotionDerivatives& motion,
                              const LossSums& sums,
                              const MotionMatrix& inverse);

}  // namespace rgbd_pose
