#pragma once

#include <ceres/loss_function.h>

#include "core/estimation/batch_loss.h"

namespace rgbd_pose {

// A loss as seen by residuals whose sigma is `scale` times the nominal one:
// rho(s) = factor scale^2 base(s / scale^2). For every M-estimator with a width
// this is the same M-estimator with `scale` times the width.
class ScaledLoss final : public BatchLoss {
 public:
  // `base` must outlive this; null is least squares.
  ScaledLoss(const ceres::LossFunction* base, double scale, double factor = 1.0)
      : base_(base), scale2_(scale * scale), factor_(factor) {}

  void Evaluate(double s, double rho[3]) const override {
    if (base_ == nullptr) {
      rho[0] = factor_ * s;
      rho[1] = factor_;
      rho[2] = 0.0;
      return;
    }
    base_->Evaluate(s / scale2_, rho);
    rho[0] *= factor_ * scale2_;
    rho[1] *= factor_;
    rho[2] *= factor_ / scale2_;
  }

  double Weigh(const double* s, int n, double* weights) const override {
    const double inverse = 1.0 / scale2_;
    for (int i = 0; i < n; ++i) weights[i] = s[i] * inverse;
    const double sum = rgbd_pose::Weigh(base_, weights, n, weights);
    if (factor_ != 1.0) {
      for (int i = 0; i < n; ++i) weights[i] *= factor_;
    }
    return factor_ * scale2_ * sum;
  }

 private:
  const ceres::LossFunction* base_;
  double scale2_;
  double factor_;
};

}  // namespace rgbd_pose
