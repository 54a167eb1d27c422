// The sandwich A^-1 B A^-1, compared with numbers worked out by hand.

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/estimation/covariance_accumulator.h"
#include "core/estimation/motion_cost.h"

namespace rgbd_pose {
namespace {

constexpr int kGroup = 0;

MotionMatrix SomeHessian(double seed) {
  MotionMatrix root = MotionMatrix::Identity();
  for (int i = 0; i < 36; ++i) root(i) += 0.3 * std::sin(seed + i);
  return root.transpose() * root;
}

// 100 blocks of 3 rows; mean psi^2 0.9, mean weight 0.8, mean slope 0.6.
CovarianceTerm Whitened(double seed) {
  CovarianceTerm term;
  term.hessian = SomeHessian(seed);
  term.scatter.setConstant(1e9);  // not used
  term.is_whitened = true;
  term.scale_group = kGroup;
  term.sums = {270.0, 240.0, 180.0, 100, 240.0};
  return term;
}

MotionMatrix Covariance(const std::vector<CovarianceTerm>& terms) {
  MotionMatrix sum = MotionMatrix::Zero();
  for (const CovarianceTerm& term : terms) sum += term.hessian;
  return RobustCovariance(terms, sum.inverse());
}

// The variance of rows: the noise model counts as six that it predicts.
double Spread(double psi2, double weight, double fitted = 6.0) {
  return (psi2 + 6.0) / (std::max(weight - fitted, 0.0) + 6.0);
}

void ExpectNear(const MotionMatrix& a, const MotionMatrix& b) {
  EXPECT_TRUE(a.isApprox(b, 1e-9)) << a << "\n\n" << b;
}

TEST(RobustCovarianceTest, OfAWhitenedCost) {
  const CovarianceTerm term = Whitened(1.0);
  const double slope = 180.0 / 240.0;
  ExpectNear(Covariance({term}),
             Spread(270.0, 240.0) / (slope * slope) * term.hessian.inverse());
}

// A vanishing slope must not make the covariance infinite.
TEST(RobustCovarianceTest, TheSlopeIsAFifthOfTheWeightAtLeast) {
  CovarianceTerm term = Whitened(1.0);
  term.sums.slope_p = -10.0;
  ExpectNear(Covariance({term}),
             Spread(270.0, 240.0) / (0.2 * 0.2) * term.hessian.inverse());
}

// Six rows or fewer fit exactly, which says nothing about their noise.
TEST(RobustCovarianceTest, FewRowsHaveTheVarianceOfTheNoiseModel) {
  CovarianceTerm term = Whitened(1.0);
  for (const double rows : {3.0, 6.0}) {
    term.sums = {0.0, rows, rows, 3, rows};
    ExpectNear(Covariance({term}),
               Spread(0.05 * 0.05 * rows, rows) * term.hessian.inverse());
  }
  term.sums = {20.0, 8.0, 8.0, 3, 8.0};
  ExpectNear(Covariance({term}),
             (20.0 + 6.0) / (2.0 + 6.0) * term.hessian.inverse());
}

// A frame against itself is not known better than depths are rounded.
TEST(RobustCovarianceTest, ResidualsThatAreZeroAreRounded) {
  CovarianceTerm term = Whitened(1.0);
  term.sums = {0.0, 240.0, 240.0, 100, 240.0};
  const MotionMatrix rounded = Covariance({term});
  ExpectNear(rounded,
             Spread(0.05 * 0.05 * 240.0, 240.0) * term.hessian.inverse());
  term.is_whitened = false;
  ExpectNear(Covariance({term}), rounded);
}

TEST(RobustCovarianceTest, OfACostThatIsNotWhitenedByItsScatter) {
  CovarianceTerm term = Whitened(1.0);
  term.is_whitened = false;
  term.scatter = SomeHessian(7.0);
  const double slope = 180.0 / 240.0;
  const MotionMatrix inverse = term.hessian.inverse();
  const auto from_blocks = [&](double blocks) -> MotionMatrix {
    const MotionMatrix scatter =
        blocks / (blocks - 7.0) * term.scatter + 6.0 / 240.0 * term.hessian;
    return 1.0 / (slope * slope) * inverse * scatter * inverse;
  };
  ExpectNear(Covariance({term}), from_blocks(100.0));
  // The scatter of fewer than 30 blocks is too uncertain to be used.
  term.sums.blocks = 30.0;
  ExpectNear(Covariance({term}), from_blocks(30.0));
  term.sums.blocks = 29.9;
  ExpectNear(Covariance({term}),
             Spread(270.0, 240.0) / (slope * slope) * inverse);
}

// The information of a prior is known: it is changed neither by losses nor by
// the fit. The parameters it determines are not counted as fitted to the
// matches.
TEST(RobustCovarianceTest, APriorCountsAsItIs) {
  const CovarianceTerm term = Whitened(1.0);
  CovarianceTerm prior = Whitened(2.0);
  prior.hessian = 3.0 * SomeHessian(2.0);
  prior.scale_group = MotionCost::kFixedScale;
  const MotionMatrix inverse = (term.hessian + prior.hessian).inverse();
  const double parameters = (inverse * term.hessian).trace();
  EXPECT_LT(parameters, 5.0);
  const MotionMatrix A = 180.0 / 240.0 * term.hessian + prior.hessian;
  const MotionMatrix B =
      Spread(270.0, 240.0, parameters) * term.hessian + prior.hessian;
  ExpectNear(Covariance({term, prior}), A.inverse() * B * A.inverse());
}

// Two costs of one group use the sums of both; another group uses its own.
TEST(RobustCovarianceTest, GroupsAreJudgedApart) {
  CovarianceTerm first = Whitened(1.0), second = Whitened(2.0);
  CovarianceTerm other = Whitened(3.0);
  second.sums = {30.0, 60.0, 45.0, 20, 60.0};
  other.sums = {50.0, 100.0, 90.0, 40, 100.0};
  other.scale_group = kGroup + 1;
  const MotionMatrix both = first.hessian + second.hessian;
  const MotionMatrix inverse = (both + other.hessian).inverse();
  const double fitted = (inverse * both).trace();
  const MotionMatrix A = 225.0 / 300.0 * both + 0.9 * other.hessian;
  const MotionMatrix B = Spread(300.0, 300.0, fitted) * both +
                         Spread(50.0, 100.0, 6.0 - fitted) * other.hessian;
  ExpectNear(Covariance({first, second, other}), A.inverse() * B * A.inverse());
}

}  // namespace
}  // namespace rgbd_pose
