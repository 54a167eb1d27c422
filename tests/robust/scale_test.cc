#include "robust/scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/util/named_values.h"

namespace rgbd_pose {
namespace {

std::vector<ScaleEstimator> Estimators() {
  std::vector<ScaleEstimator> rows;
  for (const ScaleEstimator& row : ScaleEstimators()) {
    if (row.estimate != nullptr) rows.push_back(row);
  }
  return rows;
}

std::vector<double> NormalValues(int n, std::mt19937* generator) {
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<double> values(n);
  for (double& value : values) value = normal(*generator);
  return values;
}

double Kth(std::vector<double> values, size_t k) {  // k >= 1
  std::sort(values.begin(), values.end());
  return values[k - 1];
}

// The estimators by their definitions, without constants.
double Plain(std::string_view name, const std::vector<double>& x) {
  const size_t n = x.size();
  const size_t h = n / 2 + 1;
  const auto median = [n](const std::vector<double>& values) {
    return 0.5 * (Kth(values, (n + 1) / 2) + Kth(values, n / 2 + 1));
  };
  std::vector<double> outer;
  if (name == "mad") {
    const double centre = median(x);
    for (const double value : x) outer.push_back(std::abs(value - centre));
    return median(outer);
  }
  if (name == "sn") {
    for (const double a : x) {
      std::vector<double> inner;
      for (const double b : x) inner.push_back(std::abs(a - b));
      outer.push_back(Kth(inner, h));
    }
    return Kth(outer, (n + 1) / 2);
  }
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j < i; ++j) outer.push_back(std::abs(x[i] - x[j]));
  }
  return Kth(outer, h * (h - 1) / 2);
}

// The constant for n values: the ratio of the estimate to its definition.
double Constant(const ScaleEstimator& row, int n) {
  std::vector<double> values(n);
  for (int i = 0; i < n; ++i) values[i] = i;
  const double plain = Plain(row.name, values);
  return row.estimate(&values) / plain;
}

TEST(ScaleTest, AreTheirDefinitions) {
  constexpr double kRounding = 1e-12;
  std::mt19937 generator(1);
  std::vector<int> sizes = {1001};
  for (int n = 2; n <= 60; ++n) sizes.push_back(n);
  for (const ScaleEstimator& row : Estimators()) {
    for (const int n : sizes) {
      const double constant = Constant(row, n);
      for (const int ties : {0, 1, 2}) {  // none, some, many
        for (int trial = 0; trial < (n < 100 ? 10 : 1); ++trial) {
          std::vector<double> values = NormalValues(n, &generator);
          for (double& value : values) {
            if (ties == 1) value = std::round(4.0 * value) / 4.0;
            if (ties == 2) value = std::round(value);
          }
          const double expected = constant * Plain(row.name, values);
          EXPECT_NEAR(row.estimate(&values), expected, kRounding)
              << row.name << ", n = " << n << ", ties " << ties;
        }
      }
    }
  }
}

// The mean over many normal samples is 1, whatever their size.
TEST(ScaleTest, AreUnbiasedForSmallSamples) {
  constexpr int kTrials = 20000;
  // 1 % for the factors' three digits and the formula beyond 9, plus three
  // sigmas of the mean; a single estimate deviates by up to 0.8.
  constexpr double kTolerance = 0.01 + 3 * 0.0057;
  std::mt19937 generator(2);
  for (const ScaleEstimator& row : Estimators()) {
    for (const int n : {2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 20, 21}) {
      double sum = 0.0;
      for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<double> values = NormalValues(n, &generator);
        sum += row.estimate(&values);
      }
      EXPECT_NEAR(sum / kTrials, 1.0, kTolerance) << row.name << ", n = " << n;
    }
  }
}

// Quantile of the normal distribution, by bisection.
double Quantile(double probability) {
  double low = -10.0, high = 10.0;
  while (high - low > 1e-12) {
    const double x = 0.5 * (low + high);
    (0.5 * std::erfc(-x / std::sqrt(2.0)) < probability ? low : high) = x;
  }
  return low;
}

// Values spaced evenly over the normal distribution have a spread of 1.
TEST(ScaleTest, AreConsistent) {
  constexpr int kSize = 20001;
  constexpr double kTolerance = 2e-4;  // few values and four-digit constants
  for (const ScaleEstimator& row : Estimators()) {
    std::vector<double> values;
    for (int i = 0; i < kSize; ++i) {
      values.push_back(Quantile((i + 0.5) / kSize));
    }
    EXPECT_NEAR(row.estimate(&values), 1.0, kTolerance) << row.name;
  }
}

// Efficiencies of 37, 58 and 82 %: an estimate from n values deviates by
// sqrt(1 / (2 n efficiency)), 0.6 to 0.8 % here.
TEST(ScaleTest, AreAsEfficientAsSaid) {
  constexpr int kSize = 20000;
  constexpr int kTrials = 60;
  for (const ScaleEstimator& row : Estimators()) {
    const double efficiency =
        row.name == "mad" ? 0.37 : (row.name == "sn" ? 0.58 : 0.82);
    const double sigma = std::sqrt(1.0 / (2.0 * kSize * efficiency));
    std::mt19937 generator(3);
    double sum2 = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<double> values = NormalValues(kSize, &generator);
      const double error = row.estimate(&values) - 1.0;
      EXPECT_LE(std::abs(error), 4.0 * sigma) << row.name;
      sum2 += error * error;
    }
    // The variance of 60 samples is known to sqrt(2 / 60) = 18 %.
    EXPECT_NEAR(sum2 / kTrials / (sigma * sigma), 1.0, 3 * 0.18) << row.name;
  }
}

TEST(ScaleTest, ShiftAndScaleFollow) {
  constexpr double kRounding = 1e-10;
  std::mt19937 generator(4);
  for (const ScaleEstimator& row : Estimators()) {
    std::vector<double> values = NormalValues(101, &generator);
    std::vector<double> moved;
    for (const double value : values) moved.push_back(1000.0 - 7.0 * value);
    EXPECT_NEAR(row.estimate(&moved), 7.0 * row.estimate(&values), kRounding)
        << row.name;
  }
}

// With 40 % of the values at the worst place, on one side and however far out,
// the estimates stay within their largest possible bias.
TEST(ScaleTest, SurviveFortyPercentOutliers) {
  constexpr int kSize = 1000;
  for (const ScaleEstimator& row : Estimators()) {
    for (const double where : {10.0, 1e6, 1e300}) {
      std::mt19937 generator(5);
      std::vector<double> values = NormalValues(kSize, &generator);
      for (int i = 0; i < 0.4 * kSize; ++i)
        values[i] = where * (1.0 + 1e-3 * i);
      const double sigma = row.estimate(&values);
      EXPECT_GT(sigma, 1.0) << row.name;
      EXPECT_LT(sigma, 4.0) << row.name << ", outliers at " << where;
    }
  }
}

TEST(ScaleTest, HasADefinedAnswerForFewAndEqualValues) {
  for (const ScaleEstimator& row : Estimators()) {
    std::vector<double> none;
    EXPECT_EQ(row.estimate(&none), 0.0) << row.name;
    std::vector<double> one = {3.0};
    EXPECT_EQ(row.estimate(&one), 0.0) << row.name;
    for (const int n : {2, 3, 4, 9, 10, 11, 100}) {
      std::mt19937 generator(6);
      std::vector<double> values = NormalValues(n, &generator);
      std::fill(values.begin(), values.begin() + n / 2 + 1, 0.25);
      EXPECT_EQ(row.estimate(&values), 0.0) << row.name << ", n = " << n;
    }
    const double largest = std::numeric_limits<double>::max() / 8.0;
    std::vector<double> tiny_and_huge = {5e-324, 0.0, 1e-323, 1.0, largest};
    EXPECT_TRUE(std::isfinite(row.estimate(&tiny_and_huge))) << row.name;
  }
}

TEST(ScaleTest, HasTheseNames) {
  EXPECT_EQ(NamesOf(ScaleEstimators()),
            (std::vector<std::string>{"fixed", "mad", "sn", "qn"}));
  EXPECT_EQ(FindNamed(ScaleEstimators(), "fixed")->estimate, nullptr);
  EXPECT_EQ(FindNamed(ScaleEstimators(), "mad")->estimate, MadScale);
}

}  // namespace
}  // namespace rgbd_pose
