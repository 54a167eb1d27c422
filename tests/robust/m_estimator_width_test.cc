// Recomputes the widths in the table of M-estimators.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>

#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

double Weight(const ceres::LossFunction& loss, double x) {
  double rho[3];
  loss.Evaluate(x * x, rho);
  return rho[1];
}

// Asymptotic efficiency of a location estimate in p dimensions under normal
// noise: (E[div psi] / p)^2 / (E[psi^2] / p), where E[div psi] = E[w r^2] by
// Stein's lemma; r is chi distributed.
double Efficiency(const ceres::LossFunction& loss, int p) {
  constexpr int kSteps = 8000;
  constexpr double kFar = 12.0;
  double slope = 0.0, psi2 = 0.0, mass = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = (i + 0.5) * kFar / kSteps;
    const double density = std::pow(x, p - 1) * std::exp(-x * x / 2);
    const double weight = Weight(loss, x);
    slope += density * weight * x * x / p;
    psi2 += density * weight * weight * x * x / p;
    mass += density;
  }
  slope /= mass;
  psi2 /= mass;
  return slope * slope / psi2;
}

// The width with the given efficiency, by bisection; wider is more efficient.
double FindWidth(const MEstimator& row, int p, double efficiency) {
  double low = 0.2, high = 20.0;
  while (high - low > 1e-6) {
    const double width = 0.5 * (low + high);
    (Efficiency(*row.make(width), p) < efficiency ? low : high) = width;
  }
  return low;
}

TEST(MEstimatorWidthTest, WidthsGive95PercentEfficiency) {
  constexpr double kPrinted = 0.6e-4;  // four decimals
  for (const MEstimator& row : MEstimators()) {
    if (row.make == nullptr) continue;
    for (int p = 1; p <= MEstimator::kMaxDimension; ++p) {
      if (row.Width95(1) != 1.0) {  // tuned
        EXPECT_NEAR(row.Width95(p), FindWidth(row, p, 0.95), kPrinted)
            << row.name << ", p = " << p;
      } else {
        EXPECT_EQ(row.Width95(p), 1.0) << row.name;
      }
    }
  }
}

// Efficiencies of L1, Lp and t, which are not tuned.
TEST(MEstimatorWidthTest, EfficiencyOfThoseNotTuned) {
  constexpr double kPrinted = 0.001;
  const std::map<std::string, std::array<double, 3>> expected = {
      {"l1", {0.644, 0.849, 0.920}},  // p = 1: 2 / pi up to epsilon
      {"lp", {0.788, 0.907, 0.950}},
      {"student_t", {0.942, 0.927, 0.921}}};
  for (const auto& [name, efficiencies] : expected) {
    int i = 0;
    for (const int p : {1, 3, 6}) {
      EXPECT_NEAR(Efficiency(*ParseLoss(name).Make(p), p), efficiencies[i++],
                  kPrinted)
          << name << ", p = " << p;
    }
  }
}

// Scalar widths printed in the literature.
TEST(MEstimatorWidthTest, ScalarWidthsAreTheKnownOnes) {
  const std::map<std::string, double> known = {{"fair", 1.3998},
                                               {"huber", 1.345},
                                               {"cauchy", 2.3849},
                                               {"welsch", 2.9846},
                                               {"tukey", 4.6851}};
  for (const auto& [name, width] : known) {
    EXPECT_NEAR(FindNamed(MEstimators(), name)->Width95(1), width, 1e-4)
        << name;
  }
}

}  // namespace
}  // namespace rgbd_pose
