#include "robust/m_estimator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace rgbd_pose {
namespace {

struct RhoWeight {
  double rho;
  double weight;
};

// Zhang's formulas by name, independent of Ceres.
RhoWeight Zhang(std::string_view name, double x, double c) {
  const double q = x / c;
  if (name == "huber") {
    return x <= c ? RhoWeight{x * x / 2, 1.0}
                  : RhoWeight{c * (x - c / 2), c / x};
  }
  if (name == "cauchy") {
    return {c * c / 2 * std::log1p(q * q), 1 / (1 + q * q)};
  }
  if (name == "tukey") {
    const double t = 1 - q * q;
    return x <= c ? RhoWeight{c * c / 6 * (1 - t * t * t), t * t}
                  : RhoWeight{c * c / 6, 0.0};
  }
  return {x * x / 2, 1.0};
}

TEST(MEstimatorTest, AreZhangsFormulas) {
  constexpr double kRounding = 1e-12;
  for (const MEstimator& row : MEstimators()) {
    if (row.make == nullptr) continue;
    for (const double width : {0.5, 2.0, 7.0}) {
      const std::unique_ptr<ceres::LossFunction> loss = row.make(width);
      for (double x = 0.05; x < 20.0; x *= 1.3) {
        double rho[3];
        loss->Evaluate(x * x, rho);
        const RhoWeight expected = Zhang(row.name, x, width);
        EXPECT_NEAR(rho[0], 2 * expected.rho, kRounding * (1 + rho[0]))
            << row.name << " at " << x;
        EXPECT_NEAR(rho[1], expected.weight, kRounding) << row.name;
      }
    }
  }
}

// rho' and rho'' against central differences on both sides of the width.
TEST(MEstimatorTest, DerivativesMatchDifferences) {
  for (const MEstimator& row : MEstimators()) {
    if (row.make == nullptr) continue;
    const double width = 2.0;
    const std::unique_ptr<ceres::LossFunction> loss = row.make(width);
    for (const double s : {0.3, 1.0, 3.5, 4.5, 9.0, 40.0}) {
      constexpr double kStep = 1e-5;
      constexpr double kTolerance = 1e-8;  // of a central difference
      double low[3], at[3], high[3];
      loss->Evaluate(s - kStep, low);
      loss->Evaluate(s, at);
      loss->Evaluate(s + kStep, high);
      EXPECT_NEAR(at[1], (high[0] - low[0]) / (2 * kStep), kTolerance)
          << row.name << " at " << s;
      EXPECT_NEAR(at[2], (high[1] - low[1]) / (2 * kStep), kTolerance)
          << row.name << " at " << s;
      EXPECT_LE(at[2], 0.0) << "the compressed block relies on it";
    }
  }
}

// Asymptotic efficiency of a location estimate in p dimensions under normal
// noise: (E[psi' + (p - 1) psi / r] / p)^2 / (E[psi^2] / p), r = chi_p.
double Efficiency(const ceres::LossFunction& loss, int p) {
  constexpr int kSteps = 200000;
  constexpr double kFar = 12.0;
  double slope = 0.0, psi2 = 0.0, mass = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = (i + 0.5) * kFar / kSteps;
    const double density = std::pow(x, p - 1) * std::exp(-x * x / 2);
    double rho[3];
    loss.Evaluate(x * x, rho);
    const double psi_slope = rho[1] + 2 * x * x * rho[2];
    slope += density * (psi_slope + (p - 1) * rho[1]) / p;
    psi2 += density * rho[1] * rho[1] * x * x / p;
    mass += density;
  }
  slope /= mass;
  psi2 /= mass;
  return slope * slope / psi2;
}

TEST(MEstimatorTest, WidthsGive95PercentEfficiency) {
  // Four printed decimals of the width are worth so much efficiency.
  constexpr double kTolerance = 2e-5;
  for (const MEstimator& row : MEstimators()) {
    if (row.make == nullptr) continue;
    for (int p = 1; p <= MEstimator::kMaxDimension; ++p) {
      EXPECT_NEAR(Efficiency(*row.make(row.Width95(p)), p), 0.95, kTolerance)
          << row.name << ", p = " << p;
    }
  }
}

TEST(MEstimatorTest, FindsByName) {
  for (const std::string& name : MEstimatorNames()) {
    ASSERT_NE(FindMEstimator(name), nullptr);
    EXPECT_EQ(FindMEstimator(name)->name, name);
  }
  EXPECT_EQ(FindMEstimator("tuckey"), nullptr);
}

}  // namespace
}  // namespace rgbd_pose
