#pragma once

#include <ceres/loss_function.h>

#include <cstring>

#include "core/util/vector_lanes.h"

namespace rgbd_pose {

// A loss that can weigh many residuals in one call: for compressed sums, where
// a virtual call per match would cost as much as the arithmetic.
class BatchLoss : public ceres::LossFunction {
 public:
  // weights[i] = rho'(s[i]) for n squared norms; returns the sum of rho(s[i]).
  // `weights` may be `s` itself.
  virtual double Weigh(const double* s, int n, double* weights) const = 0;
};

// The same for any loss; null means least squares.
inline double Weigh(const ceres::LossFunction* loss, const double* s, int n,
                    double* weights) {
  if (const auto* batch = dynamic_cast<const BatchLoss*>(loss)) {
    return batch->Weigh(s, n, weights);
  }
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    double rho[3] = {s[i], 1.0, 0.0};
    if (loss != nullptr) loss->Evaluate(s[i], rho);
    sum += rho[0];
    weights[i] = rho[1];
  }
  return sum;
}

namespace packed {

template <typename Formula>
struct WeighKernel {
  template <int W>
  [[gnu::always_inline]] static void Run(const Formula& formula,
                                         const double* s, int n,
                                         double* weights, double* sum) {
    using D = typename Lanes<W>::Type;
    D total = {};
    const auto add = [&](int first, size_t lanes) {
      D x = {}, rho, weight;  // rho(0) = 0: spare lanes add nothing
      std::memcpy(&x, s + first, lanes * sizeof(double));
      formula.Weigh(x, &rho, &weight);
      total += rho;
      std::memcpy(weights + first, &weight, lanes * sizeof(double));
    };
    int i = 0;
    for (; i + W <= n; i += W) add(i, W);
    if (i < n) add(i, n - i);
    *sum = 0.0;
    for (int lane = 0; lane < W; ++lane) *sum += total[lane];
  }
};

}  // namespace packed

// The loss of a formula that works lane by lane. For T double or a vector of
// doubles (core/util/vector_lanes.h), the formula implements
//
//   Weigh(const T& s, T* rho, T* weight)   rho(s) and rho'(s), rho(0) = 0
//   Curvature(double s)                    rho''(s)
template <typename Formula>
class BatchLossOf final : public BatchLoss {
 public:
  explicit BatchLossOf(double width) : formula_(width) {}

  void Evaluate(double s, double rho[3]) const override {
    formula_.Weigh(s, &rho[0], &rho[1]);
    rho[2] = formula_.Curvature(s);
  }

  double Weigh(const double* s, int n, double* weights) const override {
    double sum = 0.0;
    double* const at = &sum;
    RunVectorised<packed::WeighKernel<Formula>>(formula_, s, n, weights, at);
    return sum;
  }

 private:
  Formula formula_;
};

// A loss for residuals whose sigma is `scale` times the nominal one: rho(s) =
// factor scale^2 base(s / scale^2). For every M-estimator with a width this is
// the same M-estimator with `scale` times the width.
class ScaledLoss final : public BatchLoss {
 public:
  // `base` must outlive this object; null means least squares.
  ScaledLoss(const ceres::LossFunction* base, double scale, double factor = 1.0)
      : base_(base), scale2_(scale * scale), factor_(factor) {}

  // Whether the base grows without bound in slope towards 0, like |x|.
  bool IsSteepAtZero() const {
    if (base_ == nullptr) return false;
    constexpr double kAlmostZero = 1e-8, kQuarter = 0.25;
    double at_zero[3], beside[3];
    base_->Evaluate(kAlmostZero, at_zero);
    base_->Evaluate(kQuarter, beside);
    return at_zero[1] > 2.0 * beside[1];
  }

  // From now on the slope of squared norms below `limit`, sigmas^2, is that at
  // the limit. For a loss that is steep at 0, this is the slope of the mean
  // score over the residuals near 0, as a covariance needs it, instead of that
  // of the few residuals that happen to be almost 0: the fitted ones.
  void FlattenBelow(double limit) { flat_ = limit; }

  void Evaluate(double s, double rho[3]) const override {
    if (s < flat_ * scale2_) {
      double beside[3];
      base_->Evaluate(flat_, beside);
      rho[1] = factor_ * beside[1];
      rho[0] = rho[1] * s;
      rho[2] = 0.0;
      return;
    }
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
    if (flat_ > 0.0) {
      double sum = 0.0, rho[3];
      for (int i = 0; i < n; ++i) {
        Evaluate(s[i], rho);
        sum += rho[0];
        weights[i] = rho[1];
      }
      return sum;
    }
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
  double flat_ = 0.0;  // see FlattenBelow
};

}  // namespace rgbd_pose
