// Compares the reusable block with plain Ceres: one block for each residual.

#include "costs/assembly/compressed_block.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "costs/assembly/compressed_residuals.h"
#include "tests/support/problem_sums.h"

namespace rgbd_pose {
namespace {

constexpr double kSameSum = 1e-10;

// y = sum of x[k] cos(k t) + x[0]^2 sin(t): K parameters, two rows.
template <int K>
struct WaveResidual {
  static constexpr int kRows = 2, kParameters = K;
  double t, y;

  bool operator()(const double* x, double* r, double* J) const {
    r[0] = x[0] * x[0] * std::sin(t) - y;
    for (int k = 0; k < K; ++k) {
      r[0] += x[k] * std::cos(k * t);
    }
    r[1] = 0.1 * x[0];
    if (J == nullptr) return true;
    for (int k = 0; k < K; ++k) {
      J[k] = std::cos(k * t);
      J[K + k] = k == 0 ? 0.1 : 0.0;
    }
    J[0] += 2.0 * x[0] * std::sin(t);
    return true;
  }
};

// The same residual as a plain Ceres block.
template <typename Residual>
class PlainBlock final
    : public ceres::SizedCostFunction<Residual::kRows, Residual::kParameters> {
 public:
  explicit PlainBlock(const Residual& residual) : residual_(residual) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    return residual_(parameters[0], residuals,
                     jacobians != nullptr ? jacobians[0] : nullptr);
  }

 private:
  Residual residual_;
};

template <int K>
std::vector<WaveResidual<K>> Waves() {
  std::vector<WaveResidual<K>> residuals;
  for (int i = 0; i < 200; ++i) {
    const double t = 0.031 * i;
    const double wrong = i % 7 == 0 ? 5.0 : 0.0;
    residuals.push_back({t, 2.0 * std::cos(t) - 0.5 * std::sin(3 * t) + wrong});
  }
  return residuals;
}

template <typename Residual>
void AddTo(ceres::Problem* problem, const std::vector<Residual>& residuals,
           ceres::LossFunction* loss, bool compressed, double* x) {
  if (compressed) {
    problem->AddResidualBlock(MakeCompressedBlock(&residuals, loss), nullptr,
                              x);
    return;
  }
  for (const Residual& residual : residuals) {
    problem->AddResidualBlock(new PlainBlock<Residual>(residual), loss, x);
  }
}

ceres::Problem::Options KeepingLosses() {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

ceres::Solver::Summary Solve(ceres::Problem* problem) {
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem, &summary);
  return summary;
}

template <int K>
void ExpectTheSameSteps(ceres::LossFunction* loss) {
  SCOPED_TRACE(K);
  const auto residuals = Waves<K>();
  Eigen::Matrix<double, K, 1> x[2];
  ceres::Solver::Summary summaries[2];
  for (const bool compressed : {false, true}) {
    x[compressed].setConstant(0.3);
    ceres::Problem problem(KeepingLosses());
    AddTo(&problem, residuals, loss, compressed, x[compressed].data());
    summaries[compressed] = Solve(&problem);
  }
  ASSERT_GT(summaries[0].iterations.size(), 2u) << "a vacuous problem";
  ExpectSameSteps(summaries[1], summaries[0], kSameSum);
  EXPECT_LE((x[1] - x[0]).norm(), 1e-8);
}

TEST(CompressedBlockTest, TakesTheStepsOfPlainCeres) {
  ceres::HuberLoss huber(0.5);
  ceres::CauchyLoss cauchy(0.5);
  ceres::TolerantLoss tolerant(1.0, 0.5);  // rho'' > 0
  for (ceres::LossFunction* loss : std::initializer_list<ceres::LossFunction*>{
           nullptr, &huber, &cauchy, &tolerant}) {
    ExpectTheSameSteps<1>(loss);
    ExpectTheSameSteps<3>(loss);
    ExpectTheSameSteps<6>(loss);
    ExpectTheSameSteps<12>(loss);
  }
}

TEST(CompressedBlockTest, CostOnlyIsTheCost) {
  const auto residuals = Waves<3>();
  const std::unique_ptr<ceres::CostFunction> block(
      MakeCompressedBlock(&residuals));
  const double x[3] = {0.3, 0.2, 0.1};
  const double* parameters[] = {x};
  double with[4], without[4], J[12];
  double* jacobians[] = {J};
  ASSERT_TRUE(block->Evaluate(parameters, without, nullptr));
  ASSERT_TRUE(block->Evaluate(parameters, with, jacobians));
  double cost_with = 0.0, cost_without = 0.0;
  for (int i = 0; i < 4; ++i) {
    cost_with += with[i] * with[i];
    cost_without += without[i] * without[i];
  }
  EXPECT_NEAR(cost_with, cost_without, kSameSum * cost_without);
}

// A parameter without influence makes H singular; it must not change.
struct BlindResidual {
  static constexpr int kRows = 1, kParameters = 2;
  double y;
  bool operator()(const double* x, double* r, double* J) const {
    r[0] = x[0] - y;
    if (J == nullptr) return true;
    J[0] = 1.0;
    J[1] = 0.0;
    return true;
  }
};

TEST(CompressedBlockTest, SurvivesASingularHessian) {
  const std::vector<BlindResidual> residuals = {{1.0}, {2.0}, {3.0}};
  double x[2] = {0.0, 7.0};
  ceres::Problem problem;
  problem.AddResidualBlock(MakeCompressedBlock(&residuals), nullptr, x);
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-16;  // Ceres damps; converge fully
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_TRUE(summary.IsSolutionUsable());
  EXPECT_NEAR(x[0], 2.0, 1e-8);
  EXPECT_NEAR(x[1], 7.0, 1e-8);
}

// R p + t - q with the motion exp(x[0..2]), x[3..5]; rotation to first order.
struct PointResidual {
  static constexpr int kRows = 3, kParameters = 6;
  Eigen::Vector3d p, q;
  bool operator()(const double* x, double* r, double* J) const {
    const Eigen::Vector3d w(x[0], x[1], x[2]), t(x[3], x[4], x[5]);
    Eigen::Map<Eigen::Vector3d> error(r);
    error = p + w.cross(p) + t - q;
    if (J == nullptr) return true;
    Eigen::Map<Eigen::Matrix<double, 3, 6, Eigen::RowMajor>> jacobian(J);
    for (int k = 0; k < 3; ++k) {
      jacobian.col(k) = Eigen::Vector3d::Unit(k).cross(p);
    }
    jacobian.rightCols<3>().setIdentity();
    return true;
  }
};

// Cost and gradient at x, compressed and as plain blocks.
template <typename Residual>
void ExpectTheSameGradient(const std::vector<Residual>& residuals,
                           ceres::LossFunction* loss, std::vector<double> x) {
  std::vector<double> gradients[2];
  double costs[2];
  for (const bool compressed : {false, true}) {
    ceres::Problem problem(KeepingLosses());
    AddTo(&problem, residuals, loss, compressed, x.data());
    ASSERT_TRUE(problem.Evaluate({}, &costs[compressed], nullptr,
                                 &gradients[compressed], nullptr));
  }
  EXPECT_NEAR(costs[1], costs[0], kSameSum * costs[0]);
  for (size_t k = 0; k < x.size(); ++k) {
    EXPECT_NEAR(gradients[1][k], gradients[0][k], kSameSum * costs[0]) << k;
  }
}

// Behind its flat part this loss is s - 1: the cost of points that all are too
// far away is smaller than g^T H^-1 g / 2.
TEST(CompressedBlockTest, GradientIsExactWhereTheCostIsSmall) {
  ceres::TolerantLoss loss(1.0, 0.02);
  ExpectTheSameGradient<BlindResidual>({{0.0}, {0.1}, {-0.1}}, &loss,
                                       {1.3, 7.0});
  std::vector<PointResidual> points;
  for (int i = 0; i < 10; ++i) {
    points.push_back({{std::sin(i), std::cos(2 * i), std::sin(3 * i)}, {}});
    points.back().q = points.back().p;
  }
  ExpectTheSameGradient(points, &loss, {0.01, 0.02, 0.0, 1.2, 0.3, 0.0});
}

// Whether Ceres finds a covariance for the motion of `count` points that span
// `dimensions` dimensions (a line, a plane, space), in units of `unit`.
bool HasCovariance(int count, int dimensions, double unit, int seed,
                   bool compressed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  const Eigen::Vector3d origin = draw();
  const Eigen::Matrix3d axes =
      (Eigen::Matrix3d() << draw(), draw(), draw()).finished();
  std::vector<PointResidual> residuals;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p =
        origin + axes.leftCols(dimensions) * draw().head(dimensions);
    residuals.push_back({unit * p, unit * (p + 0.01 * draw())});
  }
  double x[6] = {0.0};
  ceres::Problem problem;
  AddTo(&problem, residuals, nullptr, compressed, x);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  ceres::Covariance covariance(options);
  return covariance.Compute(
      std::vector<std::pair<const double*, const double*>>{{x, x}}, &problem);
}

// Rounding errors in H must not count as information.
TEST(CompressedBlockTest, CovarianceKnowsWhatPointsDoNotDetermine) {
  struct Points {
    int count, dimensions;
    bool determine_a_motion;
  };
  for (const Points& points : {Points{300, 1, false},
                               {2, 1, false},
                               {1, 1, false},
                               {3, 2, true},
                               {300, 2, true},
                               {300, 3, true}}) {
    for (const double unit : {1e-3, 1.0, 1e3}) {
      for (int seed = 0; seed < 10; ++seed) {
        for (const bool compressed : {false, true}) {
          EXPECT_EQ(HasCovariance(points.count, points.dimensions, unit, seed,
                                  compressed),
                    points.determine_a_motion)
              << points.count << " points of " << points.dimensions
              << " dimensions, unit " << unit << ", compressed " << compressed;
        }
      }
    }
  }
}

// As documented in docs/compressed_block.md.
TEST(CompressedBlockTest, LossesStayAndGradientsAreNotChecked) {
  const auto residuals = Waves<3>();
  ceres::HuberLoss loss(0.5);
  double x[3] = {0.3, 0.3, 0.3};
  ceres::Problem problem(KeepingLosses());
  AddTo(&problem, residuals, &loss, /*compressed=*/true, x);
  ceres::Problem::EvaluateOptions without;
  without.apply_loss_function = false;
  double cost, cost_without;
  problem.Evaluate({}, &cost, nullptr, nullptr, nullptr);
  problem.Evaluate(without, &cost_without, nullptr, nullptr, nullptr);
  EXPECT_EQ(cost_without, cost);
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.check_gradients = true;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_EQ(summary.termination_type, ceres::FAILURE) << summary.message;
}

struct FailingResidual {
  static constexpr int kRows = 1, kParameters = 1;
  bool operator()(const double*, double*, double*) const { return false; }
};

TEST(CompressedBlockTest, PassesOnAFailure) {
  const std::vector<FailingResidual> residuals(3);
  const std::unique_ptr<ceres::CostFunction> block(
      MakeCompressedBlock(&residuals));
  const double x = 0.0;
  const double* parameters[] = {&x};
  double r[2];
  EXPECT_FALSE(block->Evaluate(parameters, r, nullptr));
}

// From x = 10 the first steps lead to x < 0, where the residual is NaN.
struct LogResidual {
  static constexpr int kRows = 1, kParameters = 1;
  double y;
  bool operator()(const double* x, double* r, double* J) const {
    r[0] = std::log(x[0]) - y;
    if (J != nullptr) J[0] = 1.0 / x[0];
    return true;
  }
};

TEST(CompressedBlockTest, RejectsStepsToWhereResidualsAreNotFinite) {
  const std::vector<LogResidual> residuals = {{0.1}, {0.3}};
  ceres::TukeyLoss tukey(20.0);  // treats NaN as an outlier
  for (ceres::LossFunction* loss :
       std::initializer_list<ceres::LossFunction*>{nullptr, &tukey}) {
    double x[2] = {10.0, 10.0};
    ceres::Solver::Summary summaries[2];
    for (const bool compressed : {false, true}) {
      ceres::Problem problem(KeepingLosses());
      AddTo(&problem, residuals, loss, compressed, &x[compressed]);
      summaries[compressed] = Solve(&problem);
    }
    ASSERT_EQ(summaries[0].termination_type, ceres::CONVERGENCE);
    EXPECT_EQ(summaries[1].termination_type, ceres::CONVERGENCE);
    EXPECT_EQ(summaries[1].iterations.size(), summaries[0].iterations.size());
    EXPECT_GT(summaries[0].num_unsuccessful_steps, 0) << "a vacuous problem";
    EXPECT_NEAR(x[1], std::exp(0.2), 1e-4);
  }
}

TEST(CompressedBlockTest, SumsThatAreNotFiniteAreAFailedEvaluation) {
  const double kNan = std::nan("");
  const CompressedSums<1> good = {Eigen::Matrix<double, 1, 1>(2.0),
                                  Eigen::Matrix<double, 1, 1>(1.0), 1.0};
  double r[2], J[2];
  EXPECT_TRUE(FactorSums(good, r, J));
  CompressedSums<1> no_cost = good, no_gradient = good, no_hessian = good;
  no_cost.cost = no_gradient.gradient[0] = no_hessian.hessian(0, 0) = kNan;
  EXPECT_FALSE(FactorSums(no_cost, r, static_cast<double*>(nullptr)));
  for (const auto& bad : {no_cost, no_gradient, no_hessian}) {
    EXPECT_FALSE(FactorSums(bad, r, J));
  }
}

// x - y.
struct Distance {
  static constexpr int kRows = 1, kParameters = 1;
  double y;
  bool operator()(const double* x, double* r, double* J) const {
    r[0] = x[0] - y;
    if (J != nullptr) J[0] = 1.0;
    return true;
  }
};

// Loss and data may change while x stays: nothing may be kept of a solve.
TEST(CompressedBlockTest, FollowsALossAndDataThatChangeBetweenSolves) {
  std::vector<Distance> residuals = {{0.0}, {0.1}, {10.0}};
  ceres::LossFunctionWrapper loss(nullptr, ceres::TAKE_OWNERSHIP);
  double x = 3.0;
  ceres::Problem problem(KeepingLosses());
  AddTo(&problem, residuals, &loss, /*compressed=*/true, &x);
  const auto gradient = [&problem] {
    std::vector<double> sum;
    problem.Evaluate({}, nullptr, nullptr, &sum, nullptr);
    return sum[0];
  };
  Solve(&problem);
  EXPECT_NEAR(x, 10.1 / 3.0, 1e-2);  // Ceres uses damping
  double cost;
  problem.Evaluate({}, &cost, nullptr, nullptr, nullptr);
  loss.Reset(new ceres::HuberLoss(0.5), ceres::TAKE_OWNERSHIP);
  EXPECT_NEAR(gradient(), 0.5, 1e-6);  // two up, one down
  EXPECT_GT(Solve(&problem).num_successful_steps, 1);
  EXPECT_NEAR(x, 0.3, 1e-2);  // 2 x - 0.1 = 0.5
  problem.Evaluate({}, &cost, nullptr, nullptr, nullptr);
  residuals[2].y = -10.0;
  EXPECT_NEAR(gradient(), 1.0, 1e-2);
}

}  // namespace
}  // namespace rgbd_pose
