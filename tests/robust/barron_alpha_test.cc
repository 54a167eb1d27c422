#include "robust/barron_alpha.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "robust/barron_loss.h"

namespace rgbd_pose {
namespace {

constexpr int kSize = 2000;
constexpr double kStep = 0.25;  // of the search

// Norms of normal residuals of unit sigma; a share of them is uniform within
// `far`.
std::vector<double> Norms(int dimension, double outlier_share, double far,
                          unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, far);
  std::vector<double> norms;
  for (int i = 0; i < kSize; ++i) {
    double s = 0.0;
    for (int k = 0; k < dimension; ++k) s += std::pow(normal(generator), 2);
    norms.push_back(i < outlier_share * kSize ? uniform(generator)
                                              : std::sqrt(s));
  }
  return norms;
}

TEST(BarronAlphaTest, NormalNormsAskForLeastSquares) {
  for (const int dimension : {1, 2, 3, 6}) {
    EXPECT_EQ(MostLikelyBarronAlpha(Norms(dimension, 0.0, 0.0, 1), dimension),
              2.0);
  }
  EXPECT_EQ(MostLikelyBarronAlpha({}, 3), 2.0);
}

TEST(BarronAlphaTest, MoreOutliersAskForLowerShapes) {
  for (const int dimension : {1, 3, 6}) {
    double above = 2.0;
    for (const double share : {0.05, 0.2, 0.5}) {
      const double alpha =
          MostLikelyBarronAlpha(Norms(dimension, share, 100.0, 2), dimension);
      EXPECT_LT(alpha, above) << dimension << " dimensions, " << share;
      above = alpha;
    }
  }
}

TEST(BarronAlphaTest, WidthIsTheUnit) {
  std::vector<double> norms = Norms(3, 0.2, 30.0, 3);
  const double expected = MostLikelyBarronAlpha(norms, 3);
  EXPECT_LT(expected, 2.0);
  for (double& norm : norms) norm *= 0.01;
  EXPECT_EQ(MostLikelyBarronAlpha(norms, 3, 0.01), expected);
}

// Norms drawn from the density of a shape, by rejection, give it back.
TEST(BarronAlphaTest, FindsTheShapeNormsWereDrawnWith) {
  for (const double alpha : {1.5, 1.0, 0.5, 0.0, -1.0}) {
    const BarronLoss loss(1.0, alpha);
    std::mt19937 generator(4);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<double> norms;
    while (norms.size() < 20000) {
      const double x = 10.0 * uniform(generator);
      double rho[3];
      loss.Evaluate(x * x, rho);
      if (uniform(generator) < std::exp(-0.5 * rho[0])) norms.push_back(x);
    }
    EXPECT_NEAR(MostLikelyBarronAlpha(norms, 1), alpha, kStep);
  }
}

}  // namespace
}  // namespace rgbd_pose
