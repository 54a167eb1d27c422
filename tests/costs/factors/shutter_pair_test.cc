// All matches of two rolling shutters in one block are the problem with one
// block per match: the same cost, gradient and Hessian, and so the same steps.

#include "costs/factors/shutter_pair.h"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/factors/factor.h"
#include "core/factors/pose_manifold.h"
#include "costs/cost_list.h"
#include "costs/factors/constant_velocity.h"
#include "robust/m_estimator.h"
#include "tests/support/both_jacobians.h"
#include "tests/support/problem_sums.h"
#include "tests/support/shutter_scene.h"

namespace rgbd_pose {
namespace {

constexpr double kEqual = 1e-11;

// Epipolar lines hardly determine the length of a baseline. A direction as weak
// as this counts as undetermined (docs/compressed_block.md), so that its part
// of the gradient is missing, which is at most sqrt(2e-14 * 18).
template <typename Type>
constexpr double kSameSums = std::is_same_v<Type, Epipolar> ? 1e-6 : kEqual;

using MakeLoss = std::function<std::unique_ptr<ceres::LossFunction>()>;
using State = std::vector<std::vector<double>>;

// Noisy matches, some of them wrong, and a state that is near the truth.
template <typename Type>
struct PairData {
  explicit PairData(unsigned seed, double seconds = 0.02) {
    ShutterScene<Type> scene(seed);
    for (int i = 0; i < 60; ++i) {
      matches.push_back(scene.Match(seconds, /*noise=*/true, i % 5 == 0));
    }
    state = scene.Blocks();
    for (const int pose : {0, 2}) {
      const MotionVector off = scene.random.template Vector<6>(0.01);
      PoseBlock::Plus(state[pose].data(), off.data(), state[pose].data());
    }
    for (const int twist : {1, 3}) {
      for (double& value : state[twist]) {
        value += scene.random.Uniform(-0.1, 0.1);
      }
    }
  }

  std::vector<ShutterMatchFactor<Type>> matches;
  State state;
};

// Both ways to put the same matches into a problem.
enum class Way { kPair, kPerMatch };

template <typename Type>
std::unique_ptr<ceres::Problem> MakeProblem(Way way, const PairData<Type>& data,
                                            const MakeLoss& make_loss,
                                            State* x) {
  auto problem = std::make_unique<ceres::Problem>();
  std::vector<double*> blocks;
  for (std::vector<double>& block : *x) blocks.push_back(block.data());
  for (const int pose : {0, 2}) AddPose(blocks[pose], problem.get());
  if (way == Way::kPair) {
    problem->AddResidualBlock(
        new ShutterPairFactor<Type>(data.matches, make_loss()), nullptr,
        blocks);
    return problem;
  }
  for (const ShutterMatchFactor<Type>& match : data.matches) {
    problem->AddResidualBlock(MakeFactor(match), make_loss().release(), blocks);
  }
  return problem;
}

template <typename Type>
double ErrorOfSums(const PairData<Type>& data, const MakeLoss& make_loss) {
  std::array<State, 2> x = {data.state, data.state};
  return SumsError(
      SumsOf(MakeProblem(Way::kPair, data, make_loss, &x[0]).get()),
      SumsOf(MakeProblem(Way::kPerMatch, data, make_loss, &x[1]).get()));
}

template <typename Type>
class ShutterPairTest : public testing::Test {};

TYPED_TEST_SUITE(ShutterPairTest, AsGTestTypes<ResidualTypes>::type, CostName);

TYPED_TEST(ShutterPairTest, HasTheSumsOfOneBlockPerMatch) {
  for (const MEstimator& loss : MEstimators()) {
    for (int seed = 0; seed < 5; ++seed) {
      SCOPED_TRACE(loss.name);
      const double error = ErrorOfSums(PairData<TypeParam>(seed), [&loss] {
        return WideLoss(loss, TypeParam::kDegreesOfFreedom);
      });
      EXPECT_LE(error, kSameSums<TypeParam>);
    }
  }
}

// Rows that are exposed at the stamps say nothing about velocities.
TYPED_TEST(ShutterPairTest, VelocitiesMayBeUndetermined) {
  const PairData<TypeParam> data(1, /*seconds=*/0.0);
  EXPECT_LE(ErrorOfSums(data, [] { return nullptr; }), kSameSums<TypeParam>);
}

TEST(ShutterPairLossTest, ALossMayBeConvex) {
  const PairData<BidirectionalPoint> data(2);
  const MakeLoss make = [] {
    return std::make_unique<ceres::TolerantLoss>(100.0, 50.0);
  };
  double rho[3];
  make()->Evaluate(100.0, rho);
  EXPECT_GT(rho[2], 0.0);
  EXPECT_LE(ErrorOfSums(data, make), kEqual);
}

// Nothing is kept between evaluations at one state.
TEST(ShutterPairLossTest, ALossMayChange) {
  const PairData<BidirectionalPoint> data(3);
  auto owned = std::make_unique<ceres::LossFunctionWrapper>(
      new ceres::CauchyLoss(2.0), ceres::TAKE_OWNERSHIP);
  ceres::LossFunctionWrapper* const loss = owned.get();
  State x = data.state;
  const auto problem = MakeProblem<BidirectionalPoint>(
      Way::kPair, data, [&owned] { return std::move(owned); }, &x);
  const auto cost = [&problem] {
    double only = 0.0;
    problem->Evaluate({}, &only, nullptr, nullptr, nullptr);
    EXPECT_NEAR(SumsOf(problem.get()).cost, only, kEqual * only);
    return only;
  };
  const double cauchy = cost();
  loss->Reset(nullptr, ceres::TAKE_OWNERSHIP);
  EXPECT_GT(cost(), 2.0 * cauchy);
}

// The pair with one column of its Jacobian negated.
class WrongSign final : public ceres::CostFunction {
 public:
  WrongSign(std::unique_ptr<ceres::CostFunction> right, int block, int column)
      : right_(std::move(right)), block_(block), column_(column) {
    set_num_residuals(right_->num_residuals());
    *mutable_parameter_block_sizes() = right_->parameter_block_sizes();
  }

  bool Evaluate(double const* const* x, double* residuals,
                double** jacobians) const override {
    if (!right_->Evaluate(x, residuals, jacobians)) return false;
    const int columns = parameter_block_sizes()[block_];
    for (int row = 0; jacobians != nullptr && row < num_residuals(); ++row) {
      jacobians[block_][row * columns + column_] *= -1.0;
    }
    return true;
  }

 private:
  const std::unique_ptr<ceres::CostFunction> right_;
  const int block_, column_;
};

// What these tests compare tells every wrong sign.
TEST(ShutterPairSumsTest, AWrongSignIsFound) {
  using Type = BidirectionalPoint;
  const PairData<Type> data(4);
  State x = data.state;
  const auto per_match = MakeProblem(
      Way::kPerMatch, data, [] { return nullptr; }, &x);
  const ProblemSums right = SumsOf(per_match.get());
  for (int block = 0; block < 4; ++block) {
    for (size_t column = 0; column < x[block].size(); ++column) {
      ceres::Problem problem;
      for (const int pose : {0, 2}) AddPose(x[pose].data(), &problem);
      problem.AddResidualBlock(
          new WrongSign(std::make_unique<ShutterPairFactor<Type>>(data.matches),
                        block, static_cast<int>(column)),
          nullptr, x[0].data(), x[1].data(), x[2].data(), x[3].data());
      EXPECT_GT(SumsError(SumsOf(&problem), right), 1e-3)
          << "block " << block << ", column " << column;
    }
  }
}

// With constant blocks, and a pose that is held in part.
TEST(ShutterPairSolveTest, SolversTakeTheSameSteps) {
  using Type = BidirectionalPoint;
  const PairData<Type> data(5);
  const MakeLoss make_loss = [] {
    return WideLoss(*FindNamed(MEstimators(), "cauchy"),
                    Type::kDegreesOfFreedom);
  };
  for (const auto solver_type :
       {ceres::DENSE_QR, ceres::DENSE_SCHUR, ceres::SPARSE_NORMAL_CHOLESKY}) {
    for (const bool in_part : {false, true}) {
      std::array<State, 2> x = {data.state, data.state};
      std::array<ceres::Solver::Summary, 2> summaries;
      for (const Way way : {Way::kPair, Way::kPerMatch}) {
        const int i = static_cast<int>(way);
        const auto problem = MakeProblem(way, data, make_loss, &x[i]);
        problem->AddResidualBlock(MakeFactor(ConstantVelocityFactor{0.1}),
                                  nullptr, x[i][0].data(), x[i][1].data(),
                                  x[i][2].data(), x[i][3].data());
        problem->SetParameterBlockConstant(x[i][0].data());
        if (in_part) {
          problem->SetParameterBlockConstant(x[i][1].data());
          AddPose(x[i][2].data(), problem.get(), new PoseManifold({1, 5}));
        }
        ceres::Solver::Options options;
        options.linear_solver_type = solver_type;
        options.num_threads = 2;
        options.function_tolerance = 1e-12;
        ceres::Solve(options, problem.get(), &summaries[i]);
        EXPECT_TRUE(summaries[i].IsSolutionUsable());
      }
      ExpectSameSteps(summaries[0], summaries[1], 1e-9);
      for (int block = 0; block < 4; ++block) {
        for (size_t k = 0; k < x[0][block].size(); ++k) {
          EXPECT_NEAR(x[0][block][k], x[1][block][k], 1e-8);
        }
        EXPECT_EQ(x[0][block] == data.state[block],
                  block == 0 || (in_part && block == 1));
      }
      EXPECT_LT(summaries[0].final_cost, summaries[0].initial_cost);
    }
  }
}

TEST(ShutterPairDataTest, NoMatchesCostNothing) {
  const ShutterPairFactor<BidirectionalPoint> factor({});
  State x = PairData<BidirectionalPoint>(6).state;
  const double* blocks[] = {x[0].data(), x[1].data(), x[2].data(), x[3].data()};
  Eigen::Matrix<double, 19, 1> r;
  Eigen::Matrix<double, 19, 7> J;
  double* jacobians[] = {J.data(), nullptr, nullptr, nullptr};
  EXPECT_TRUE(factor.Evaluate(blocks, r.data(), jacobians));
  EXPECT_EQ(r.norm(), 0.0);
  EXPECT_EQ(J.norm(), 0.0);
}

// Also under a loss that would leave it out.
TEST(ShutterPairDataTest, WhatIsNotFiniteIsRefused) {
  const PairData<BidirectionalPoint> data(7);
  const ShutterPairFactor<BidirectionalPoint> factor(
      data.matches, std::make_unique<ceres::TukeyLoss>(2.0));
  for (int block = 0; block < 4; ++block) {
    State x = data.state;
    x[block].back() = std::numeric_limits<double>::quiet_NaN();
    const double* blocks[] = {x[0].data(), x[1].data(), x[2].data(),
                              x[3].data()};
    double r[19], J[19 * 7];
    EXPECT_FALSE(factor.Evaluate(blocks, r, nullptr));
    double* jacobians[] = {J, nullptr, nullptr, nullptr};
    EXPECT_FALSE(factor.Evaluate(blocks, r, jacobians));
  }
}

}  // namespace
}  // namespace rgbd_pose
