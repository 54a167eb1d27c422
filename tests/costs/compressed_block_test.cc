// The reusable block against plain Ceres: the same residuals, one block each.

#include "costs/assembly/compressed_block.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "costs/assembly/compressed_residuals.h"

namespace rgbd_pose {
namespace {

constexpr double kEqual = 1e-10;

// y = sum of x[k] cos(k t) + x[0]^2 sin(t): K parameters, two rows.
template <int K>
struct WaveResidual {
  static constexpr int kRows = 2, kParameters = K;
  double t, y;

  bool operator()(const double* x, double* r, double* J) const {
    r[0] = x[0] * x[0] * std::sin(t) - y;
    for (int k = 0; k < K; ++k) {
      r[0] += x[k] * std::cos(k * t);
      J[k] = std::cos(k * t);
      J[K + k] = k == 0 ? 0.1 : 0.0;
    }
    J[0] += 2.0 * x[0] * std::sin(t);
    r[1] = 0.1 * x[0];
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
    double unused[Residual::kRows * Residual::kParameters];
    const bool wanted = jacobians != nullptr && jacobians[0] != nullptr;
    return residual_(parameters[0], residuals, wanted ? jacobians[0] : unused);
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

template <int K>
struct Solved {
  Eigen::Matrix<double, K, 1> x = Eigen::Matrix<double, K, 1>::Constant(0.3);
  ceres::Solver::Summary summary;
};

template <int K>
Solved<K> Solve(const std::vector<WaveResidual<K>>& residuals,
                ceres::LossFunction* loss, bool compressed) {
  Solved<K> solved;
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  if (compressed) {
    problem.AddResidualBlock(MakeCompressedBlock(&residuals, loss), nullptr,
                             solved.x.data());
  } else {
    for (const auto& residual : residuals) {
      problem.AddResidualBlock(new PlainBlock<WaveResidual<K>>(residual), loss,
                               solved.x.data());
    }
  }
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 12;
  ceres::Solve(options, &problem, &solved.summary);
  return solved;
}

template <int K>
void ExpectTheSameSteps(ceres::LossFunction* loss) {
  const auto residuals = Waves<K>();
  const Solved<K> plain = Solve(residuals, loss, false);
  const Solved<K> compressed = Solve(residuals, loss, true);
  const auto& expected = plain.summary.iterations;
  const auto& actual = compressed.summary.iterations;
  ASSERT_EQ(actual.size(), expected.size()) << "K = " << K;
  ASSERT_GT(expected.size(), 2u) << "a vacuous problem";
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(actual[i].cost, expected[i].cost, kEqual * expected[0].cost);
  }
  EXPECT_LE((compressed.x - plain.x).norm(), 1e-8) << "K = " << K;
}

TEST(CompressedBlockTest, TakesTheStepsOfPlainCeres) {
  ceres::HuberLoss huber(0.5);
  ceres::CauchyLoss cauchy(0.5);
  for (ceres::LossFunction* loss :
       {static_cast<ceres::LossFunction*>(nullptr),
        static_cast<ceres::LossFunction*>(&huber),
        static_cast<ceres::LossFunction*>(&cauchy)}) {
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
  EXPECT_NEAR(cost_with, cost_without, kEqual * cost_without);
}

// A parameter without any influence makes H singular; it must stay put.
struct BlindResidual {
  static constexpr int kRows = 1, kParameters = 2;
  double y;
  bool operator()(const double* x, double* r, double* J) const {
    r[0] = x[0] - y;
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
  options.function_tolerance = 1e-16;  // Ceres damps; go on to the end
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_TRUE(summary.IsSolutionUsable());
  EXPECT_NEAR(x[0], 2.0, 1e-8);
  EXPECT_NEAR(x[1], 7.0, 1e-8);
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

}  // namespace
}  // namespace rgbd_pose
