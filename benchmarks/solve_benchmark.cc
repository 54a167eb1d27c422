// One pose solve from matches: building the problem and solving it.

#include <benchmark/benchmark.h>
#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <memory>
#include <string>

#include "core/cost.h"
#include "core/estimator.h"
#include "costs/cost_factory.h"
#include "frontend/synthetic_matches.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

constexpr double kOutlierShare = 0.2;
constexpr int kMaxIterations = 50;
constexpr double kTolerance = 1e-6;  // Ceres' defaults

// Matches whose motion is small, as from frame to frame, so that one stage
// finds it: what is compared is the solve, not the graduation.
struct World {
  Correspondences matches;
  std::unique_ptr<Cost> cost;
  std::unique_ptr<ceres::LossFunction> loss;

  World(int count, const std::string& cost_name, const std::string& loss_name)
      : cost(MakeCost(cost_name)),
        loss(FindMEstimator(loss_name)->MakeLoss(cost->independent_rows())) {
    RandomWorld world(1);
    matches = world.Matches(count, kOutlierShare, world.Motion(0.005, 0.005));
  }
};

ceres::Solver::Options SolverOptions(ceres::LinearSolverType linear) {
  ceres::Solver::Options options;
  options.linear_solver_type = linear;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = kMaxIterations;
  return options;
}

void SolveWithCeres(benchmark::State& state, Assembly assembly,
                    ceres::LinearSolverType linear, const std::string& loss) {
  World world(static_cast<int>(state.range(0)), "bidirectional_point", loss);
  const MotionOrigin origin;
  double iterations = 0.0;
  for (auto _ : state) {
    MotionVector x = MotionVector::Zero();
    world.cost->Bind({world.matches, Rigid3d()});
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = BlockOwnership(assembly);
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.disable_all_safety_checks = true;
    ceres::Problem problem(problem_options);
    world.cost->AddTo(assembly, origin, world.loss.get(), x.data(), &problem);
    ceres::Solver::Summary summary;
    ceres::Solve(SolverOptions(linear), &problem, &summary);
    iterations = static_cast<double>(summary.iterations.size()) - 1.0;
    benchmark::DoNotOptimize(x);
  }
  state.counters["iterations"] = iterations;
}

// The limit: Gauss-Newton on the same sums without Ceres.
void BareLoop(benchmark::State& state, const std::string& loss) {
  World world(static_cast<int>(state.range(0)), "bidirectional_point", loss);
  const MotionOrigin origin;
  int iterations = 0;
  for (auto _ : state) {
    MotionVector x = MotionVector::Zero();
    world.cost->Bind({world.matches, Rigid3d()});
    double last_cost = 0.0;
    for (iterations = 0; iterations < kMaxIterations; ++iterations) {
      NormalEquations sum;
      world.cost->Linearise(origin.DerivativesAt(x.data()), world.loss.get(),
                            &sum);
      if (iterations > 0 &&
          std::abs(last_cost - sum.cost) <= kTolerance * last_cost) {
        break;
      }
      last_cost = sum.cost;
      x -= sum.hessian.ldlt().solve(sum.gradient);
    }
    benchmark::DoNotOptimize(x);
  }
  state.counters["iterations"] = iterations;
}

// Ceres' solver for tiny problems on the compressed sums.
struct TinyFunction {
  using Scalar = double;
  enum { NUM_RESIDUALS = 7, NUM_PARAMETERS = 6 };

  bool operator()(const double* x, double* residuals, double* jacobian) const {
    double row_major[42];
    double* jacobians[] = {jacobian != nullptr ? row_major : nullptr};
    const double* parameters[] = {x};
    if (!block->Evaluate(parameters, residuals, jacobians)) return false;
    if (jacobian == nullptr) return true;
    Eigen::Map<Eigen::Matrix<double, 7, 6>> column_major(jacobian);
    column_major =
        Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(row_major);
    return true;
  }

  const ceres::CostFunction* block;
};

void SolveWithTinySolver(benchmark::State& state, const std::string& loss) {
  World world(static_cast<int>(state.range(0)), "bidirectional_point", loss);
  const MotionOrigin origin;
  for (auto _ : state) {
    MotionVector x = MotionVector::Zero();
    world.cost->Bind({world.matches, Rigid3d()});
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership =
        BlockOwnership(Assembly::kCompressed);
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(problem_options);
    world.cost->AddTo(Assembly::kCompressed, origin, world.loss.get(), x.data(),
                      &problem);
    std::vector<ceres::ResidualBlockId> blocks;
    problem.GetResidualBlocks(&blocks);
    const TinyFunction function{
        problem.GetCostFunctionForResidualBlock(blocks[0])};
    ceres::TinySolver<TinyFunction> solver;
    solver.options.max_num_iterations = kMaxIterations;
    solver.Solve(function, &x);
    benchmark::DoNotOptimize(x);
  }
}

// The whole estimate: graduation, covariance, inliers.
void Estimate(benchmark::State& state, Assembly assembly,
              const std::string& loss) {
  RandomWorld random(1);
  const Correspondences matches =
      random.Matches(static_cast<int>(state.range(0)), kOutlierShare,
                     random.Motion(0.02, 0.02));
  EstimatorOptions options;
  options.assembly = assembly;
  Estimator estimator(options, MakeRobustCosts("bidirectional_point", loss));
  MotionEstimate estimate;
  for (auto _ : state) {
    estimator.Estimate(matches, Rigid3d(), nullptr, &estimate);
    benchmark::DoNotOptimize(estimate.cur_from_prev);
  }
  state.counters["iterations"] = estimate.iterations;
}

#define RGBD_POSE_SIZES \
  Arg(30)->Arg(100)->Arg(300)->Arg(1000)->Arg(10000)->Arg(100000)

BENCHMARK_CAPTURE(SolveWithCeres, compressed_qr_huber, Assembly::kCompressed,
                  ceres::DENSE_QR, "huber")
    ->RGBD_POSE_SIZES;
BENCHMARK_CAPTURE(SolveWithCeres, compressed_cholesky_huber,
                  Assembly::kCompressed, ceres::DENSE_NORMAL_CHOLESKY, "huber")
    ->RGBD_POSE_SIZES;
BENCHMARK_CAPTURE(SolveWithCeres, per_match_qr_huber, Assembly::kPerMatch,
                  ceres::DENSE_QR, "huber")
    ->RGBD_POSE_SIZES;
BENCHMARK_CAPTURE(SolveWithCeres, per_match_cholesky_huber, Assembly::kPerMatch,
                  ceres::DENSE_NORMAL_CHOLESKY, "huber")
    ->RGBD_POSE_SIZES;
BENCHMARK_CAPTURE(SolveWithCeres, autodiff_qr_huber, Assembly::kAutodiff,
                  ceres::DENSE_QR, "huber")
    ->RGBD_POSE_SIZES;
BENCHMARK_CAPTURE(SolveWithCeres, autodiff_cholesky_huber, Assembly::kAutodiff,
                  ceres::DENSE_NORMAL_CHOLESKY, "huber")
    ->RGBD_POSE_SIZES;
BENCHMARK_CAPTURE(SolveWithTinySolver, huber, "huber")->RGBD_POSE_SIZES;
BENCHMARK_CAPTURE(BareLoop, huber, "huber")->RGBD_POSE_SIZES;
BENCHMARK_CAPTURE(SolveWithCeres, compressed_qr_tukey, Assembly::kCompressed,
                  ceres::DENSE_QR, "tukey")
    ->Arg(300);
BENCHMARK_CAPTURE(SolveWithCeres, compressed_qr_none, Assembly::kCompressed,
                  ceres::DENSE_QR, "none")
    ->Arg(300);
BENCHMARK_CAPTURE(Estimate, compressed_tukey, Assembly::kCompressed, "tukey")
    ->RGBD_POSE_SIZES;
BENCHMARK_CAPTURE(Estimate, per_match_tukey, Assembly::kPerMatch, "tukey")
    ->Arg(300);
BENCHMARK_CAPTURE(Estimate, autodiff_tukey, Assembly::kAutodiff, "tukey")
    ->Arg(300);

}  // namespace
}  // namespace rgbd_pose
