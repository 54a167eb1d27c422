// Subtracting spurious information from a cost's information, tested with a
// cost whose numbers are given.

#include "core/estimation/covariance_accumulator.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <memory>
#include <utility>
#include <vector>

#include "core/estimation/motion_estimate.h"
#include "core/estimation/robust_problem.h"

namespace rgbd_pose {
namespace {

constexpr int kBlocks = 60;
constexpr double kSquaredNorm = 0.8;  // of each block
// Safety factor on the modelled spurious information.
constexpr double kMargin = 6.0;

struct MadeUp {
  MotionMatrix hessian = MotionMatrix::Identity();
  MotionMatrix spurious = MotionMatrix::Zero();
  double information = 1.0;
  int group = 0;
  int blocks = kBlocks;
  int rows = 1;
};

// A cost whose sums are given. With three rows per block, the residual of the
// last row is five times as large.
class MadeUpCost final : public MotionCost {
 public:
  explicit MadeUpCost(const MadeUp& given)
      : given_(given),
        matches_(given.blocks, -1),
        degrees_(given.blocks, given.rows) {}

  std::string_view name() const override { return "made_up"; }
  int num_residuals() const override { return given_.rows; }
  int degrees_of_freedom() const override { return given_.rows; }
  bool is_whitened() const override { return true; }
  int scale_group() const override { return given_.group; }
  double information_factor() const override { return given_.information; }
  AssociationPolicy association() const override {
    return AssociationPolicy::kOnce;
  }
  void Bind(const FramePair&) override {}
  void Associate(const Rigid3d&) override {}
  const std::vector<int>& matches() const override { return matches_; }
  const std::vector<int>& degrees() const override { return degrees_; }

  void Residuals(const MotionDerivatives&,
                 std::vector<double>* residuals) const override {
    residuals->assign(given_.blocks * given_.rows, std::sqrt(kSquaredNorm));
    for (size_t i = 2; i < residuals->size() && given_.rows == 3; i += 3) {
      (*residuals)[i] *= 5.0;
    }
  }
  void SquaredNorms(const MotionDerivatives&,
                    std::vector<double>* norms) const override {
    norms->assign(given_.blocks, kSquaredNorm);
  }
  void Linearise(const MotionDerivatives&, const ceres::LossFunction* loss,
                 NormalEquations* sum) const override {
    double rho[3] = {kSquaredNorm, 1.0, 0.0};
    if (loss != nullptr) loss->Evaluate(kSquaredNorm, rho);
    sum->hessian += rho[1] * given_.hessian;
    sum->gradient += MotionVector::LinSpaced(1.0, 6.0);
    sum->cost += 7.0;
  }
  void AddScoreOuterProduct(const MotionDerivatives&,
                            const ceres::LossFunction*,
                            MotionMatrix*) const override {}
  void AddSpuriousInformation(const MotionDerivatives&,
                              MotionMatrix* hessian) const override {
    *hessian += given_.spurious;
  }
  void AddTo(Assembly, const LinearizationPoint&, ceres::LossFunction*, double*,
             ceres::Problem*) override {}

 private:
  const MadeUp given_;
  const std::vector<int> matches_, degrees_;
};

struct Judged {
  NormalEquations sum;
  MotionMatrix covariance;
};

// `is_doubled`: the scale estimate of the residuals is 2.
Judged JudgedOf(const std::vector<MadeUp>& costs, bool is_doubled = false) {
  std::vector<RobustCost> robust;
  for (const MadeUp& cost : costs) {
    robust.push_back({std::make_unique<MadeUpCost>(cost), nullptr});
  }
  RobustProblem terms(std::move(robust));
  const MotionDerivatives motion =
      LinearizationPoint().DerivativesAt(MotionVector::Zero().eval().data());
  terms.Bind({FramePair()}, Rigid3d());
  if (is_doubled) {
    terms.UpdateScales(motion, [](std::vector<double>*) { return 2.0; });
    terms.SetLosses(1.0);
  }
  terms.UpdateNorms(motion);
  MotionEstimate estimate;
  CovarianceAccumulator shares;
  shares.JudgeMatches(terms, &estimate);
  Judged out;
  out.sum = shares.Linearise(terms, motion);
  out.covariance = shares.Covariance(terms, motion, out.sum.hessian.inverse());
  return out;
}

MotionMatrix SomeMatrix(double seed, double size) {
  MotionMatrix root = MotionMatrix::Identity();
  for (int i = 0; i < 36; ++i) root(i) += 0.3 * std::sin(seed + i);
  return size * root.transpose() * root;
}

// The variance of rows, six of which are the noise model's, after a fit.
double Spread(double blocks, double fitted) {
  return (kSquaredNorm * blocks + 6.0) / (blocks - fitted + 6.0);
}

// The scale uses all rows of a block or none, for any number of blocks.
TEST(RobustProblemTest, ScalesDoNotDependOnTheNumberOfResiduals) {
  const auto scale_of = [](int blocks) {
    MadeUp cost;
    cost.rows = 3;
    cost.blocks = blocks;
    std::vector<RobustCost> robust;
    robust.push_back({std::make_unique<MadeUpCost>(cost), nullptr});
    RobustProblem terms(std::move(robust));
    terms.Bind({FramePair()}, Rigid3d());
    terms.UpdateScales(
        LinearizationPoint().DerivativesAt(MotionVector::Zero().eval().data()),
        [](std::vector<double>* values) {
          double sum = 0.0;
          for (const double value : *values) sum += value;
          return sum / static_cast<double>(values->size());
        });
    return terms.scale();
  };
  const double expected = std::sqrt(kSquaredNorm) * (1.0 + 1.0 + 5.0) / 3.0;
  for (const int blocks : {100, 600, 700, 1400, 2100, 30000}) {
    EXPECT_NEAR(scale_of(blocks), expected, 1e-9) << blocks;
  }
}

TEST(CovarianceAccumulatorTest, SubtractsSpuriousInformation) {
  MadeUp cost;
  cost.hessian = SomeMatrix(1.0, 1000.0);
  cost.hessian.topRows<3>() *= 30.0;  // the units differ
  cost.hessian.leftCols<3>() *= 30.0;
  cost.spurious = SomeMatrix(2.0, 5.0);
  const Judged judged = JudgedOf({cost});
  const MotionMatrix left = cost.hessian - kMargin * cost.spurious;
  EXPECT_TRUE(judged.sum.hessian.isApprox(left, 1e-9));
  EXPECT_TRUE(judged.sum.gradient.isApprox(MotionVector::LinSpaced(1.0, 6.0)));
  EXPECT_EQ(judged.sum.cost, 7.0);
  EXPECT_TRUE(
      judged.covariance.isApprox(Spread(kBlocks, 6.0) * left.inverse(), 1e-6));
}

// The information factor scales both terms. A larger scale of the residuals
// does not increase the noise of slopes.
TEST(CovarianceAccumulatorTest, SpuriousInformationFollowsFactorAndScale) {
  MadeUp cost;
  cost.hessian = SomeMatrix(1.0, 1000.0);
  cost.spurious = SomeMatrix(2.0, 5.0);
  cost.information = 0.5;
  MotionMatrix left = 0.5 * (cost.hessian - kMargin * cost.spurious);
  EXPECT_TRUE(JudgedOf({cost}).sum.hessian.isApprox(left, 1e-9));
  left = 0.5 / 4.0 * (cost.hessian - kMargin * cost.spurious);
  EXPECT_TRUE(
      JudgedOf({cost}, /*is_doubled=*/true).sum.hessian.isApprox(left, 1e-9));
}

// Limit for an image without texture: no direction keeps negative information.
// All directions are scaled by the same factor.
TEST(CovarianceAccumulatorTest, TakesOffNoMoreThanThereIs) {
  MadeUp cost;
  cost.spurious = 0.01 * MotionMatrix::Identity();
  cost.spurious(4, 4) = 2.0;
  const MotionMatrix left = cost.hessian - 0.5 * cost.spurious;
  EXPECT_TRUE(JudgedOf({cost}).sum.hessian.isApprox(left, 1e-12));
}

// A direction with only spurious information (6.84 of 4) needs another cost.
TEST(CovarianceAccumulatorTest, InformationThatIsAllSpuriousIsZero) {
  MadeUp spurious, right;
  spurious.hessian(1, 1) = spurious.hessian(2, 2) = 4.0;
  spurious.spurious.block<2, 2>(1, 1) << 3.6, 3.24, 3.24, 3.6;  // 0.36 and 6.84
  spurious.spurious /= kMargin;
  right.hessian = 100.0 * MotionMatrix::Identity();
  const Judged judged = JudgedOf({spurious, right});
  EXPECT_TRUE(judged.sum.hessian.isApprox(
      spurious.hessian + right.hessian - kMargin * spurious.spurious, 1e-9));
  const Eigen::Vector2d all(std::sqrt(0.5), std::sqrt(0.5));
  const Eigen::Vector2d little(std::sqrt(0.5), -std::sqrt(0.5));
  MotionMatrix left = spurious.hessian + right.hessian;
  left.block<2, 2>(1, 1) -= 4.0 * all * all.transpose();  // 4.0 instead of 6.84
  left.block<2, 2>(1, 1) -= 0.36 * little * little.transpose();
  // Both costs are of one group and share its six parameters.
  const MotionMatrix inverse = judged.sum.hessian.inverse();
  const double parameters = (inverse * left).trace();
  EXPECT_TRUE(judged.covariance.isApprox(
      Spread(2.0 * kBlocks, parameters) * left.inverse(), 1e-9));
}

}  // namespace
}  // namespace rgbd_pose
