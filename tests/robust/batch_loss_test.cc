#include "core/estimation/batch_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robust/losses.h"

namespace rgbd_pose {
namespace {

constexpr double kWidth = 1.7;

// Squared norms on both sides of the width, at 0 and at the width itself.
std::vector<double> SquaredNorms(int n) {
  std::vector<double> s(n);
  for (int i = 0; i < n; ++i) s[i] = 0.37 * i * kWidth * kWidth;
  if (n > 3) s[3] = kWidth * kWidth;
  return s;
}

// Any number of residuals, in full vectors or not, gets the scalar weights.
void ExpectWeighsAsEvaluated(const ceres::LossFunction* loss) {
  for (int n = 0; n <= 19; ++n) {
    const std::vector<double> s = SquaredNorms(n);
    std::vector<double> weights(n + 1, -1.0);
    const double sum = Weigh(loss, s.data(), n, weights.data());
    double expected = 0.0;
    for (int i = 0; i < n; ++i) {
      double rho[3] = {s[i], 1.0, 0.0};
      if (loss != nullptr) loss->Evaluate(s[i], rho);
      expected += rho[0];
      // Vectors may fuse products and sums.
      EXPECT_NEAR(weights[i], rho[1], 1e-15) << i << " of " << n;
    }
    EXPECT_NEAR(sum, expected, 1e-13 * (1.0 + expected)) << n;
    EXPECT_EQ(weights[n], -1.0) << "written past the end of " << n;
  }
}

TEST(BatchLossTest, ManyWeighAsOneByOne) {
  const HuberLoss huber(kWidth);
  const TukeyLoss tukey(kWidth);
  const ceres::CauchyLoss cauchy(kWidth);
  const ScaledLoss scaled_huber(&huber, 3.0), scaled_cauchy(&cauchy, 0.4),
      scaled_none(nullptr, 2.0);
  const ceres::LossFunction* const losses[] = {
      nullptr,       &huber,         &tukey,      &cauchy,
      &scaled_huber, &scaled_cauchy, &scaled_none};
  for (const ceres::LossFunction* loss : losses) ExpectWeighsAsEvaluated(loss);
}

TEST(BatchLossTest, WeighsInPlace) {
  const TukeyLoss tukey(kWidth);
  std::vector<double> s = SquaredNorms(13);
  std::vector<double> weights(13);
  const double sum = Weigh(&tukey, s.data(), 13, weights.data());
  EXPECT_EQ(Weigh(&tukey, s.data(), 13, s.data()), sum);
  EXPECT_EQ(s, weights);
}

// The losses that Ceres also has. Tukey's formula is written out, since it
// differs by a factor of two between versions of Ceres.
TEST(BatchLossTest, FormulasAreThoseOfCeres) {
  const HuberLoss huber(kWidth);
  const ceres::HuberLoss ceres_huber(kWidth);
  const TukeyLoss tukey(kWidth);
  for (const double s : SquaredNorms(12)) {
    double rho[3], expected[3];
    huber.Evaluate(s, rho);
    ceres_huber.Evaluate(s, expected);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(rho[i], expected[i], 1e-14) << s;
    tukey.Evaluate(s, rho);
    const double c2 = kWidth * kWidth;
    const double t = s > c2 ? 0.0 : 1.0 - s / c2;
    EXPECT_NEAR(rho[0], c2 / 3.0 * (1.0 - t * t * t), 1e-14) << s;
    EXPECT_NEAR(rho[1], t * t, 1e-14) << s;
    EXPECT_NEAR(rho[2], -2.0 / c2 * t, 1e-14) << s;
  }
}

}  // namespace
}  // namespace rgbd_pose
