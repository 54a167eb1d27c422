#include "robust/m_estimator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/estimation/batch_loss.h"
#include "robust/losses.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

constexpr double kRounding = 1e-12;

// Widths on both sides of 1.
constexpr double kWidths[] = {0.5, 2.0, 7.0};

struct Rho {
  double value;
  double first;
  double second;
};

Rho Evaluate(const ceres::LossFunction& loss, double s) {
  double rho[3];
  loss.Evaluate(s, rho);
  return {rho[0], rho[1], rho[2]};
}

// All rows that have a loss.
std::vector<MEstimator> Rows() {
  std::vector<MEstimator> rows;
  for (const MEstimator& row : MEstimators()) {
    if (row.make != nullptr) rows.push_back(row);
  }
  return rows;
}

struct RhoWeight {
  double rho;
  double weight;
};

// The published rho(x) and w(x) by name, written independently: Zhang's table,
// Barron's equation 1 times c^2, -ln of Student's density scaled to w(0) = 1.
// Zhang's L1, L1-L2, Lp and Geman-McClure have no width: c^2 rho(x / c) is
// used.
RhoWeight Published(std::string_view name, double x, double c) {
  const double q = x / c;
  const double c2 = c * c;
  if (name == "l1") return {c2 * q, 1 / q};
  if (name == "lp") return {c2 * std::pow(q, 1.2) / 1.2, std::pow(q, -0.8)};
  if (name == "l1_l2") {
    return {c2 * 2 * (std::sqrt(1 + q * q / 2) - 1),
            1 / std::sqrt(1 + q * q / 2)};
  }
  if (name == "fair") return {c2 * (q - std::log(1 + q)), 1 / (1 + q)};
  if (name == "huber") {
    return x <= c ? RhoWeight{x * x / 2, 1.0}
                  : RhoWeight{c * (x - c / 2), c / x};
  }
  if (name == "cauchy") {
    return {c2 / 2 * std::log(1 + q * q), 1 / (1 + q * q)};
  }
  if (name == "geman_mcclure") {
    return {c2 * q * q / 2 / (1 + q * q), std::pow(1 + q * q, -2)};
  }
  if (name == "welsch") {
    return {c2 / 2 * (1 - std::exp(-q * q)), std::exp(-q * q)};
  }
  if (name == "tukey") {
    const double t = 1 - q * q;
    return x <= c ? RhoWeight{c2 / 6 * (1 - t * t * t), t * t}
                  : RhoWeight{c2 / 6, 0.0};
  }
  if (name == "barron") {
    const double a = -1.0, b = std::abs(a - 2);
    return {c2 * b / a * (std::pow(q * q / b + 1, a / 2) - 1),
            std::pow(q * q / b + 1, a / 2 - 1)};
  }
  if (name == "student_t") {
    const double nu = 5.0, p = 3.0;
    const double at_zero = (nu + p) / (nu * c2);  // 1/x d/dx of -ln density
    return {(nu + p) / 2 * std::log(1 + q * q / nu) / at_zero,
            (nu + p) / (nu + q * q) / c2 / at_zero};
  }
  throw std::runtime_error(
      "Published() above needs the published rho and w of " +
      std::string(name));
}

TEST(MEstimatorTest, AreThePublishedFormulas) {
  for (const MEstimator& row : Rows()) {
    // L1 and Lp are evaluated at sqrt(x^2 + epsilon^2), minus the value at 0.
    const bool is_power = row.name == "l1" || row.name == "lp";
    const double epsilon = is_power ? PowerLoss::kEpsilon : 0.0;
    for (const double c : kWidths) {
      const auto loss = row.make(c);
      const double at_zero =
          is_power ? Published(row.name, epsilon * c, c).rho : 0.0;
      for (double x = 0.05; x < 20.0; x *= 1.3) {
        const Rho actual = Evaluate(*loss, x * x);
        const RhoWeight expected =
            Published(row.name, std::hypot(x, epsilon * c), c);
        EXPECT_NEAR(actual.value, 2 * (expected.rho - at_zero),
                    kRounding * (1 + actual.value))
            << row.name << " at " << x;
        EXPECT_NEAR(actual.first, expected.weight, kRounding * 10)
            << row.name << " at " << x;
      }
    }
  }
}

// From a tenth of the width on, epsilon changes a weight by less than 1 %.
TEST(MEstimatorTest, EpsilonIsSmall) {
  for (const std::string name : {"l1", "lp"}) {
    const auto loss = FindNamed(MEstimators(), name)->make(1.0);
    const double expected = Published(name, 0.1, 1.0).weight;
    EXPECT_NEAR(Evaluate(*loss, 0.01).first, expected, 0.01 * expected);
  }
}

TEST(MEstimatorTest, StartAtZeroWithUnitSlope) {
  for (const MEstimator& row : Rows()) {
    for (const double c : kWidths) {
      const Rho rho = Evaluate(*row.make(c), 0.0);
      EXPECT_EQ(rho.value, 0.0) << row.name;
      if (row.name == "l1" || row.name == "lp") {
        const double exponent = row.name == "l1" ? 1.0 : 1.2;
        const double slope = std::pow(PowerLoss::kEpsilon, exponent - 2);
        EXPECT_NEAR(rho.first, slope, kRounding * slope) << row.name;
      } else {
        EXPECT_EQ(rho.first, 1.0) << row.name;
      }
      // Fair's second derivative is infinite there; the result must be finite.
      EXPECT_TRUE(std::isfinite(rho.second)) << row.name;
    }
  }
}

// rho' and rho'' against central differences on both sides of the width.
TEST(MEstimatorTest, DerivativesMatchDifferences) {
  for (const MEstimator& row : Rows()) {
    const auto loss = row.make(2.0);
    for (const double s : {0.3, 1.0, 3.5, 4.5, 9.0, 40.0}) {
      constexpr double kStep = 1e-5;
      constexpr double kTolerance = 1e-8;  // error of a central difference
      const Rho low = Evaluate(*loss, s - kStep);
      const Rho at = Evaluate(*loss, s);
      const Rho high = Evaluate(*loss, s + kStep);
      EXPECT_NEAR(at.first, (high.value - low.value) / (2 * kStep), kTolerance)
          << row.name << " at " << s;
      EXPECT_NEAR(at.second, (high.first - low.first) / (2 * kStep), kTolerance)
          << row.name << " at " << s;
    }
  }
}

// The compressed block relies on rho'' <= 0, the estimator on finite values.
TEST(MEstimatorTest, AreConcaveInTheSquareEverywhere) {
  for (const MEstimator& row : Rows()) {
    for (const double c : {1e-3, 1.0, 1e3}) {
      const auto loss = row.make(c);
      for (double s = 1e-18; s < 1e18; s *= 1.7) {
        const Rho rho = Evaluate(*loss, s);
        ASSERT_TRUE(std::isfinite(rho.value)) << row.name << " at " << s;
        ASSERT_GE(rho.value, 0.0) << row.name << " at " << s;
        ASSERT_GE(rho.first, 0.0) << row.name << " at " << s;
        ASSERT_LE(rho.second, 0.0) << row.name << " at " << s;
        ASSERT_TRUE(std::isfinite(rho.second)) << row.name << " at " << s;
      }
    }
  }
}

// The estimator widens losses with ScaledLoss instead of rebuilding them.
TEST(MEstimatorTest, AScaledLossIsTheLossOfScaledWidth) {
  for (const MEstimator& row : Rows()) {
    for (const double scale : {0.05, 0.7, 3.0, 200.0}) {
      const auto base = row.make(1.5);
      const ScaledLoss scaled(base.get(), scale);
      const auto expected_loss = row.make(1.5 * scale);
      for (double s = 1e-6; s < 1e6; s *= 3.0) {
        const Rho actual = Evaluate(scaled, s);
        const Rho expected = Evaluate(*expected_loss, s);
        // Differences of nearly equal numbers where s is below the width.
        const double tolerance = kRounding * (1.5 * scale) * (1.5 * scale);
        EXPECT_NEAR(actual.value, expected.value,
                    kRounding * expected.value + tolerance)
            << row.name << " at " << s;
        EXPECT_NEAR(actual.first, expected.first, kRounding * expected.first);
        EXPECT_NEAR(actual.second, expected.second,
                    -kRounding * expected.second);
      }
    }
  }
}

TEST(MEstimatorTest, FindsByName) {
  for (const std::string& name : MEstimatorNames()) {
    ASSERT_NE(FindNamed(MEstimators(), name), nullptr);
    EXPECT_EQ(FindNamed(MEstimators(), name)->name, name);
  }
  EXPECT_EQ(FindNamed(MEstimators(), "tuckey"), nullptr);
}

TEST(ParseLossTest, TakesANameOrANameAndAWidth) {
  for (const MEstimator& row : Rows()) {
    const std::string name(row.name);
    EXPECT_EQ(ParseLoss(name).row->name, row.name);
    EXPECT_EQ(ParseLoss(name).Width(3), row.Width95(3));
    const NamedLoss wide = ParseLoss(name + "(2.5)");
    for (const int dimension : {1, 3}) {
      EXPECT_EQ(wide.Width(dimension), 2.5);
      EXPECT_EQ(Evaluate(*wide.Make(dimension), 9.0).value,
                Evaluate(*row.make(2.5), 9.0).value);
    }
  }
  EXPECT_EQ(ParseLoss("none").Make(3), nullptr);
}

TEST(ParseLossTest, RefusesWhatIsNone) {
  ExpectInputError([] { ParseLoss("hubert(1)"); },
                   {"unknown loss 'hubert(1)'; available: none, l1"});
  for (const std::string text :
       {"none(1)", "huber(", "huber()", "huber(1", "huber(x)", "huber(0)",
        "huber(-1)", "huber(nan)", "huber(inf)", "huber(1e9)", "huber(1))",
        "huber(1)x", "huber( 1)", "huber(1,2)"}) {
    ExpectInputError([&] { ParseLoss(text); },
                     {"loss '" + text + "': the width", "huber(1.5)"});
  }
}

}  // namespace
}  // namespace rgbd_pose
