// Sums over many matches: chunk by chunk, on any number of threads.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "core/estimation/estimator.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/m_estimator.h"
#include "tests/support/problem_sums.h"

namespace rgbd_pose {
namespace {

// Several chunks (costs/assembly/packed_sum.h) and a partial one; not a
// multiple of the number of lanes.
constexpr int kMany = 30003;

class DenseSumsTest : public ::testing::TestWithParam<std::string> {
 protected:
  DenseSumsTest() {
    RandomWorld world(11);
    truth_ = world.Motion(0.02, 0.3);
    matches_ = world.Matches(kMany, 0.1, truth_, /*noise=*/true,
                             /*missing_depth_share=*/0.2);
  }

  NormalEquations Sum(const Correspondences& matches, int threads,
                      MotionMatrix* scatter = nullptr) const {
    const std::unique_ptr<MotionCost> cost = MakeCost(GetParam());
    const auto loss = ParseLoss("huber").Make(cost->degrees_of_freedom());
    cost->Bind({&matches, nullptr, nullptr, nullptr, threads});
    cost->Associate(truth_);
    NormalEquations sum;
    const LinearizationPoint origin(truth_);
    const MotionVector x = MotionVector::Constant(0.001);
    const MotionDerivatives motion = origin.DerivativesAt(x.data());
    cost->Linearise(motion, loss.get(), &sum);
    if (scatter != nullptr)
      cost->AddScoreOuterProduct(motion, loss.get(), scatter);
    return sum;
  }

  Rigid3d truth_;
  Correspondences matches_;
};

TEST_P(DenseSumsTest, AreTheSameToTheLastBitOnAnyNumberOfThreads) {
  const NormalEquations one = Sum(matches_, 1);
  ASSERT_GT(one.cost, 0.0);
  for (const int threads : {2, 3, 8}) {
    const NormalEquations many = Sum(matches_, threads);
    EXPECT_EQ(many.cost, one.cost) << threads;
    EXPECT_EQ(many.gradient, one.gradient) << threads;
    EXPECT_EQ(many.hessian, one.hessian) << threads;
  }
}

// Parts that each fit into one chunk add up to the whole.
TEST_P(DenseSumsTest, AreThoseOfTheirParts) {
  const NormalEquations whole = Sum(matches_, 2);
  NormalEquations parts;
  constexpr size_t kPart = 1000;
  for (size_t first = 0; first < matches_.size(); first += kPart) {
    Correspondences part(matches_.camera());
    for (size_t i = first; i < std::min(first + kPart, matches_.size()); ++i) {
      part.Add(matches_[i].prev, matches_[i].cur);
    }
    const NormalEquations sum = Sum(part, 1);
    parts.cost += sum.cost;
    parts.gradient += sum.gradient;
    parts.hessian += sum.hessian;
  }
  constexpr double kEqual = 1e-10;  // sums of tens of thousands of terms
  EXPECT_LE(SumsError(whole, parts), kEqual);
}

TEST_P(DenseSumsTest, ScatterIsThatOfTheGradientsOfEachMatch) {
  MotionMatrix expected = MotionMatrix::Zero(), scatter = MotionMatrix::Zero();
  Correspondences some(matches_.camera());
  for (size_t i = 0; i < 100; ++i) {
    some.Add(matches_[i].prev, matches_[i].cur);
    Correspondences one(matches_.camera());
    one.Add(matches_[i].prev, matches_[i].cur);
    const MotionVector gradient = Sum(one, 1).gradient;
    expected += gradient * gradient.transpose();
  }
  Sum(some, 1, &scatter);
  ASSERT_GT(expected.norm(), 0.0);
  EXPECT_LE((scatter - expected).norm(), 1e-10 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(AllCosts, DenseSumsTest,
                         ::testing::Values("bidirectional_point",
                                           "bidirectional_image",
                                           "reprojection_depth", "epipolar"),
                         [](const auto& info) { return info.param; });

TEST(DenseEstimateTest, ThreadsDoNotChangeABit) {
  RandomWorld world(12);
  const Rigid3d truth = world.Motion(0.05, 0.1);
  const Correspondences matches = world.Matches(kMany, 0.2, truth);
  std::vector<MotionEstimate> estimates;
  for (const int threads : {1, 4}) {
    EstimatorOptions options;
    options.threads = threads;
    Estimator estimator(options,
                        MakeRobustCosts("bidirectional_point", "tukey"));
    estimates.push_back(estimator.Estimate(matches));
    EXPECT_TRUE(estimates.back().ok()) << estimates.back().reason;
  }
  EXPECT_EQ(estimates[0].cur_from_prev.rotation.coeffs(),
            estimates[1].cur_from_prev.rotation.coeffs());
  EXPECT_EQ(estimates[0].cur_from_prev.translation,
            estimates[1].cur_from_prev.translation);
  EXPECT_EQ(estimates[0].covariance, estimates[1].covariance);
}

}  // namespace
}  // namespace rgbd_pose
