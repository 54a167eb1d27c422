#pragma once

#include <ceres/loss_function.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/estimation/batch_loss.h"
#include "core/util/lane_math.h"

namespace rgbd_pose {

// Below, R(s) of s = |r|^2 and a width c; the weights are in m_estimator.cc.

// As ceres::HuberLoss: R(s) = s if s <= c^2, 2 c sqrt(s) - c^2 beyond.
class HuberFormula {
 public:
  explicit HuberFormula(double width) : c_(width), c2_(width * width) {}

  template <typename T>
  void Weigh(const T& s, T* rho, T* weight) const {
    // The root of at least c^2, to avoid a division by 0 in the unused case.
    T limited;
    Max(s, c2_, &limited);
    const T root = sqrt(limited);
    const T one = T{} + 1.0;
    *rho = s > c2_ ? 2.0 * c_ * root - c2_ : s;
    *weight = s > c2_ ? c_ / root : one;
  }

  double Curvature(double s) const {
    return s > c2_ ? -0.5 * c_ / (s * std::sqrt(s)) : 0.0;
  }

 private:
  double c_, c2_;
};

using HuberLoss = BatchLossOf<HuberFormula>;

// Tukey's biweight, as ceres::TukeyLoss since Ceres 2.0 (half of that before):
// R(s) = c^2/3 (1 - (1 - s/c^2)^3) if s <= c^2, c^2/3 beyond.
class TukeyFormula {
 public:
  explicit TukeyFormula(double width) : c2_(width * width) {}

  template <typename T>
  void Weigh(const T& s, T* rho, T* weight) const {
    T rest;  // 1 - s/c^2, not below 0
    Max(T(1.0 - s / c2_), 0.0, &rest);
    *weight = rest * rest;
    *rho = c2_ / 3.0 * (1.0 - *weight * rest);
  }

  double Curvature(double s) const {
    return s > c2_ ? 0.0 : -2.0 / c2_ * (1.0 - s / c2_);
  }

 private:
  double c2_;
};

using TukeyLoss = BatchLossOf<TukeyFormula>;

// The loss of a formula that fills in R, R' and R'' at s for the width c.
template <void (*formula)(double s, double c, double rho[3])>
class LossOf final : public ceres::LossFunction {
 public:
  explicit LossOf(double width) : width_(width) {}

  void Evaluate(double s, double rho[3]) const override {
    formula(s, width_, rho);
  }

 private:
  double width_;
};

// Fair's loss: R(s) = 2 c^2 (q - ln(1 + q)), q = sqrt(s) / c. R''(0) is minus
// infinity. A huge but finite value is returned instead; with it, s R''(s) is 0
// at s = 0.
inline void Fair(double s, double c, double rho[3]) {
  constexpr double kTiny = std::numeric_limits<double>::min();
  const double q = std::sqrt(s) / c;
  const double weight = 1.0 / (1.0 + q);
  rho[0] = 2.0 * c * c * (q - std::log1p(q));
  rho[1] = weight;
  rho[2] = -0.5 * weight * weight / (c * std::sqrt(std::max(s, kTiny)));
}

// Geman and McClure's loss: R(s) = s / (1 + s/c^2). Zhang's version has c = 1.
class GemanMcClureLoss final : public ceres::LossFunction {
 public:
  explicit GemanMcClureLoss(double width) : inverse_(1.0 / (width * width)) {}

  void Evaluate(double s, double rho[3]) const override {
    const double t = 1.0 / (1.0 + s * inverse_);
    rho[0] = s * t;
    rho[1] = t * t;
    rho[2] = -2.0 * inverse_ * t * t * t;
  }

 private:
  double inverse_;
};

// Welsch's loss: R(s) = c^2 (1 - exp(-s/c^2)).
inline void Welsch(double s, double c, double rho[3]) {
  const double q = s / (c * c);
  rho[0] = -(c * c) * std::expm1(-q);
  rho[1] = std::exp(-q);
  rho[2] = -rho[1] / (c * c);
}

// |x|^v for 1 <= v < 2 (Zhang's L1 and Lp): R(s) = (2/v) c^2 (s / c^2)^(v/2).
// The width c only scales it; Zhang's versions have c = 1. As the slope at 0 is
// infinite, s is replaced by s + (kEpsilon c)^2, and the value at 0 subtracted:
// below kEpsilon widths it is least squares with weight kEpsilon^(v-2).
class PowerLoss final : public ceres::LossFunction {
 public:
  static constexpr double kEpsilon = 0.01;

  PowerLoss(double exponent, double width)
      : exponent_(exponent),
        width2_(width * width),
        at_zero_(std::pow(kEpsilon, exponent)) {}

  void Evaluate(double s, double rho[3]) const override {
    const double q = s / width2_ + kEpsilon * kEpsilon;
    const double power = std::pow(q, 0.5 * exponent_);
    rho[0] = 2.0 / exponent_ * width2_ * (power - at_zero_);
    rho[1] = power / q;
    rho[2] = (0.5 * exponent_ - 1.0) * rho[1] / (q * width2_);
  }

 private:
  double exponent_;
  double width2_;
  double at_zero_;
};

// Barron's loss (A General and Adaptive Robust Loss Function, CVPR 2019) of the
// shape -1, half-way between Cauchy (0) and Geman-McClure (-2), scaled to
// R'(0) = 1: R(s) = 6 c^2 (1 - (1 + s / (3 c^2))^(-1/2)).
inline void Barron(double s, double c, double rho[3]) {
  const double q = s / (c * c * 3.0);
  const double log = std::log1p(q);
  rho[0] = -6.0 * (c * c) * std::expm1(-0.5 * log);
  rho[1] = std::exp(-1.5 * log);
  rho[2] = -0.5 * rho[1] / (c * c * (1.0 + q));
}

}  // namespace rgbd_pose
