// A pair factor is the problem with one block per match: the same cost,
// gradient and Hessian, whatever the solver, and so the same solution.

#include "costs/factors/pair.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/covariance.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include "core/factors/check_factor.h"
#include "core/factors/factor.h"
#include "core/factors/motion_between.h"
#include "core/factors/pose_manifold.h"
#include "core/util/input_error.h"
#include "costs/assembly/cost_of.h"
#include "costs/cost_list.h"
#include "costs/factors/match.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/m_estimator.h"
#include "tests/support/both_jacobians.h"
#include "tests/support/problem_sums.h"

namespace rgbd_pose {
namespace {

constexpr int kMatches = 60;
constexpr double kEqual = 1e-12;

// Matches between two frames, some wrong and some without depth, and poses that
// are near the truth.
struct PairWorld {
  explicit PairWorld(unsigned seed) : world(seed) {
    ref = world.Motion(2.0, 2.0);
    const Rigid3d cur_from_ref = world.Motion(0.1, 0.3);
    cur = ref * cur_from_ref.Inverse();
    matches = world.Matches(kMatches, 0.2, cur_from_ref, /*noise=*/true, 0.1);
    prior = world.Prior(cur_from_ref, 0.05);
    start = {PoseVectorOf(ref * world.Motion(0.01, 0.01)),
             PoseVectorOf(cur * world.Motion(0.01, 0.01))};
  }

  Rigid3d Guess() const {
    return RigidOf(start[1]).Inverse() * RigidOf(start[0]);
  }
  FramePair Data() const { return {&matches, &prior}; }

  RandomWorld world;
  Rigid3d ref, cur;
  Correspondences matches;
  MotionPrior prior;
  std::array<PoseVector, 2> start;
};

// Both ways to put the same cost into a problem.
enum class Way { kPair, kPerMatch };

template <typename Type>
std::unique_ptr<ceres::Problem> MakeProblem(Way way, const PairWorld& data,
                                            const MEstimator& loss,
                                            std::array<PoseVector, 2>* poses) {
  auto problem = std::make_unique<ceres::Problem>();
  for (PoseVector& pose : *poses) AddPose(pose.data(), problem.get());
  double* const ref = (*poses)[0].data();
  double* const cur = (*poses)[1].data();
  const auto make_loss = [&loss] {
    return WideLoss(loss, Type::kDegreesOfFreedom);
  };
  if (way == Way::kPair) {
    problem->AddResidualBlock(new PairFactor({MakeCost<Type>(), make_loss()},
                                             data.Data(), data.Guess()),
                              nullptr, ref, cur);
    return problem;
  }
  const CostInput input{data.matches, data.Guess(), &data.prior};
  const size_t count = kHas<IsPriorOf, Type> ? 1 : data.matches.size();
  for (size_t i = 0; i < count; ++i) {
    MatchFactor<Type> factor;
    if (!Type::Pack(input, i, factor.columns.data())) continue;
    problem->AddResidualBlock(MakeFactor(factor), make_loss().release(), ref,
                              cur);
  }
  return problem;
}

template <typename Type>
class PairFactorTest : public testing::Test {};

TYPED_TEST_SUITE(PairFactorTest, AsGTestTypes<ResidualTypes>::type, CostName);

TYPED_TEST(PairFactorTest, JacobianOfAMatchIsRight) {
  RandomWorld world(1);
  CheckFactorOptions options;
  options.samples = 40;
  options.autodiff_tolerance = kEqual;
  // Pixels are not smooth over a step of 1 mrad.
  options.difference_tolerance = 1e-4;
  for (int i = 0; i < 10; ++i) {
    options.seed = i;
    const PairWorld data(i);
    MatchFactor<TypeParam> factor;
    const CostInput input{data.matches, data.Guess(), &data.prior};
    size_t match = 0;
    while (!TypeParam::Pack(input, match, factor.columns.data())) ++match;
    options.near.clear();
    for (const PoseVector& pose : data.start) {
      options.near.emplace_back(pose.data(), pose.data() + 7);
    }
    options.spread = 0.02;
    EXPECT_EQ(CheckFactor(factor, options), "");
  }
}

TYPED_TEST(PairFactorTest, HasTheSumsOfOneBlockPerMatch) {
  // Epipolar lines hardly determine the length of a baseline: a direction as
  // weak as this is treated as undetermined (docs/compressed_block.md).
  const double tolerance = std::is_same_v<TypeParam, Epipolar> ? 1e-10 : kEqual;
  for (const MEstimator& loss : MEstimators()) {
    SCOPED_TRACE(loss.name);
    const PairWorld data(3);
    std::array<PoseVector, 2> pair = data.start, match = data.start;
    const auto one = MakeProblem<TypeParam>(Way::kPair, data, loss, &pair);
    const auto many =
        MakeProblem<TypeParam>(Way::kPerMatch, data, loss, &match);
    EXPECT_LE(SumsError(SumsOf(one.get()), SumsOf(many.get())), tolerance);
  }
}

// Steps of all kinds of solvers, with a pose that is held or held in part.
TEST(PairFactorSolveTest, SolversTakeTheSameSteps) {
  using Type = BidirectionalPoint;
  const MEstimator* loss = FindNamed(MEstimators(), "cauchy");
  const PairWorld data(4);
  for (const auto solver_type :
       {ceres::DENSE_QR, ceres::DENSE_NORMAL_CHOLESKY, ceres::DENSE_SCHUR,
        ceres::SPARSE_NORMAL_CHOLESKY, ceres::ITERATIVE_SCHUR}) {
    for (const auto strategy : {ceres::LEVENBERG_MARQUARDT, ceres::DOGLEG}) {
      if (solver_type == ceres::ITERATIVE_SCHUR && strategy == ceres::DOGLEG) {
        continue;  // Ceres has none
      }
      for (const bool in_part : {false, true}) {
        std::array<std::array<PoseVector, 2>, 2> poses = {data.start,
                                                          data.start};
        std::array<ceres::Solver::Summary, 2> summaries;
        for (const Way way : {Way::kPair, Way::kPerMatch}) {
          const int i = static_cast<int>(way);
          const auto problem = MakeProblem<Type>(way, data, *loss, &poses[i]);
          problem->SetParameterBlockConstant(poses[i][0].data());
          if (in_part) {
#ifdef RGBD_POSE_LOCAL_PARAMETERIZATION
            problem->SetParameterization(poses[i][1].data(),
                                         new PoseManifold({1, 5}));
#else
            problem->SetManifold(poses[i][1].data(), new PoseManifold({1, 5}));
#endif
          }
          ceres::Solver::Options options;
          options.linear_solver_type = solver_type;
          options.trust_region_strategy_type = strategy;
          options.num_threads = 2;
          options.function_tolerance = 1e-12;
          options.eta = 1e-10;  // of the inexact solver
          ceres::Solve(options, problem.get(), &summaries[i]);
          EXPECT_TRUE(summaries[i].IsSolutionUsable());
        }
        ExpectSameSteps(summaries[0], summaries[1], 1e-9);
        EXPECT_TRUE(poses[0][1].isApprox(poses[1][1], 1e-9));
        EXPECT_LT(summaries[0].final_cost, summaries[0].initial_cost);
      }
    }
  }
}

TEST(PairFactorSolveTest, CovarianceIsTheSame) {
  using Type = BidirectionalPoint;
  const MEstimator* loss = FindNamed(MEstimators(), "huber");
  const PairWorld data(5);
  std::array<MotionMatrix, 2> covariances;
  for (const bool is_held : {true, false}) {
    for (const Way way : {Way::kPair, Way::kPerMatch}) {
      std::array<PoseVector, 2> poses = data.start;
      const auto problem = MakeProblem<Type>(way, data, *loss, &poses);
      if (is_held) problem->SetParameterBlockConstant(poses[0].data());
      ceres::Covariance::Options options;
      options.algorithm_type = ceres::DENSE_SVD;
      // Without a pose that is held the world may be anywhere.
      if (!is_held) options.null_space_rank = -1;
      ceres::Covariance covariance(options);
      const std::vector<const double*> wanted = {poses[1].data()};
      ASSERT_TRUE(covariance.Compute(wanted, problem.get()));
      ASSERT_TRUE(covariance.GetCovarianceBlockInTangentSpace(
          wanted[0], wanted[0], covariances[static_cast<int>(way)].data()));
      if (is_held) continue;
      ceres::Covariance singular({});
      EXPECT_FALSE(singular.Compute(wanted, problem.get()));
    }
    EXPECT_TRUE(covariances[0].isApprox(covariances[1], 1e-8));
  }
}

// The residual of a match between cameras that are mounted on bodies, by Jets.
template <typename Type>
struct MountedMatch {
  template <typename T>
  bool operator()(const T* ref, const T* cur, const T* ref_mounting,
                  const T* cur_mounting, T* r) const {
    const auto camera = [](const T* body, const T* mounting) {
      return Mounted(PoseBlock::Read(body), PoseBlock::Read(mounting));
    };
    Type::Residual(
        MotionBetween(camera(ref, ref_mounting), camera(cur, cur_mounting)),
        columns.data(), r);
    return true;
  }
  template <typename T>
  bool operator()(const T* ref, const T* cur, const T* mounting, T* r) const {
    return (*this)(ref, cur, mounting, mounting, r);
  }
  std::array<double, Type::kColumns> columns;
};

TEST(PairFactorMountingTest, BlocksOfMountings) {
  using Type = BidirectionalPoint;
  PairWorld data(6);
  std::array<PoseVector, 2> mountings;
  for (const auto blocks :
       {PairMounting::kNone, PairMounting::kShared, PairMounting::kEach}) {
    for (PoseVector& mounting : mountings) {
      mounting = PoseVectorOf(data.world.Motion(3.0, 0.3));
    }
    PoseVector& other =
        blocks == PairMounting::kShared ? mountings[0] : mountings[1];
    // The bodies of the cameras.
    std::array<PoseVector, 2> bodies = {
        PoseVectorOf(RigidOf(data.start[0]) * RigidOf(mountings[0]).Inverse()),
        PoseVectorOf(RigidOf(data.start[1]) * RigidOf(other).Inverse())};
    std::vector<double*> x = {bodies[0].data(), bodies[1].data(),
                              mountings[0].data(), mountings[1].data()};
    PairMounting mounting;
    mounting.blocks = blocks;
    if (blocks == PairMounting::kNone) {
      mounting.body_from_ref_cam = RigidOf(mountings[0]);
      mounting.body_from_cur_cam = RigidOf(mountings[1]);
    }
    if (blocks == PairMounting::kShared) x.pop_back();
    ceres::Problem pair, per_match;
    for (ceres::Problem* problem : {&pair, &per_match}) {
      for (double* block : x) AddPose(block, problem);
      if (blocks != PairMounting::kNone) continue;
      for (int i : {2, 3}) problem->SetParameterBlockConstant(x[i]);
    }
    std::vector<double*> of_pair = x;
    if (blocks == PairMounting::kNone) of_pair.resize(2);
    pair.AddResidualBlock(new PairFactor({MakeCost<Type>(), nullptr},
                                         data.Data(), data.Guess(), mounting),
                          nullptr, of_pair);
    for (size_t i = 0; i < data.matches.size(); ++i) {
      MountedMatch<Type> match;
      if (!Type::Pack({data.matches, data.Guess()}, i, match.columns.data())) {
        continue;
      }
      ceres::CostFunction* function = nullptr;
      if (blocks == PairMounting::kShared) {
        function = new ceres::AutoDiffCostFunction<MountedMatch<Type>,
                                                   Type::kRows, 7, 7, 7>(
            new MountedMatch<Type>(match));
      } else {
        function = new ceres::AutoDiffCostFunction<MountedMatch<Type>,
                                                   Type::kRows, 7, 7, 7, 7>(
            new MountedMatch<Type>(match));
      }
      per_match.AddResidualBlock(function, nullptr, x);
    }
    SCOPED_TRACE(blocks);
    EXPECT_LE(SumsError(SumsOf(&pair), SumsOf(&per_match)), kEqual);
  }
}

// A wrapped loss may be replaced between two evaluations at one state.
TEST(PairFactorTest, NothingIsKeptBetweenEvaluations) {
  const PairWorld data(7);
  std::array<PoseVector, 2> poses = data.start;
  auto wrapper = std::make_unique<ceres::LossFunctionWrapper>(
      new ceres::CauchyLoss(2.0), ceres::TAKE_OWNERSHIP);
  ceres::LossFunctionWrapper* const loss = wrapper.get();
  const PairFactor factor({MakeCost<BidirectionalPoint>(), std::move(wrapper)},
                          data.Data(), data.Guess());
  const double* x[] = {poses[0].data(), poses[1].data()};
  const auto cost = [&](bool with_jacobians) {
    Eigen::Matrix<double, 7, 1> r;
    Eigen::Matrix<double, 7, 7, Eigen::RowMajor> J[2];
    double* jacobians[] = {J[0].data(), J[1].data()};
    EXPECT_TRUE(
        factor.Evaluate(x, r.data(), with_jacobians ? jacobians : nullptr));
    return 0.5 * r.squaredNorm();
  };
  const double cauchy = cost(false);
  EXPECT_NEAR(cost(true), cauchy, kEqual * cauchy);
  loss->Reset(nullptr, ceres::TAKE_OWNERSHIP);
  const double squares = cost(true);
  EXPECT_GT(squares, 2.0 * cauchy);
  EXPECT_NEAR(cost(false), squares, kEqual * squares);
}

TEST(PairFactorTest, BadDataIsRefused) {
  const PairWorld data(8);
  EXPECT_THROW(PairFactor({}, data.Data(), data.Guess()), InputError);
  const PairFactor factor({MakeCost<BidirectionalPoint>(), nullptr},
                          data.Data(), data.Guess());
  std::array<PoseVector, 2> poses = data.start;
  poses[0][4] = std::numeric_limits<double>::quiet_NaN();
  const double* x[] = {poses[0].data(), poses[1].data()};
  double r[7];
  EXPECT_FALSE(factor.Evaluate(x, r, nullptr));
}

}  // namespace
}  // namespace rgbd_pose
