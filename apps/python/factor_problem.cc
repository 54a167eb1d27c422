#include "apps/python/factor_problem.h"

#include <ceres/iteration_callback.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>
#include <string_view>

#include "core/factors/pose_manifold.h"
#include "core/pose_graph/sparse_inverse.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// A solve ends where a step changes the cost or the parameters by less than
// this share, or where the gradient, of whitened residuals, is below it.
constexpr double kTolerance = 1e-12;

// Ceres' problem over the memory of `problem`, which must outlive it.
std::unique_ptr<ceres::Problem> MakeCeresProblem(FactorProblem* problem) {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  auto result = std::make_unique<ceres::Problem>(options);
  CeresManifold* manifold = nullptr;  // one for all poses
  for (FactorProblem::Block& block : problem->blocks) {
    if (IsPose(block.kind)) {
      if (manifold == nullptr) manifold = new PoseManifold();
      AddPose(block.x.data(), result.get(), manifold);
    } else {
      result->AddParameterBlock(block.x.data(), block.kind.size);
    }
    if (block.is_constant) result->SetParameterBlockConstant(block.x.data());
  }
  for (const FactorProblem::Term& term : problem->terms) {
    std::vector<double*> x;
    for (const int block : term.blocks) {
      x.push_back(problem->blocks[block].x.data());
    }
    // Ceres takes pointers to change only what it owns.
    result->AddResidualBlock(
        const_cast<SharedCostFunction*>(term.factor.function.get()),
        term.loss.get(), x);
  }
  return result;
}

// Ends a solve when asked to, and after invalid steps in a row, such as those
// to where a factor cannot be evaluated. Ceres' own limit writes to stderr.
class EndCallback final : public ceres::IterationCallback {
 public:
  explicit EndCallback(const std::function<bool()>& is_interrupted)
      : is_interrupted_(is_interrupted) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& summary) override {
    constexpr int kMaxInvalid = 5;  // Ceres' default
    const bool is_start = summary.iteration == 0;
    invalid_ = is_start || summary.step_is_valid ? 0 : invalid_ + 1;
    return is_interrupted_() || invalid_ > kMaxInvalid ? ceres::SOLVER_ABORT
                                                       : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<bool()>& is_interrupted_;
  int invalid_ = 0;
};

// J^T J of all blocks that are free, in their order.
Eigen::SparseMatrix<double> Information(FactorProblem* problem) {
  const auto ceres_problem = MakeCeresProblem(problem);
  ceres::Problem::EvaluateOptions evaluate;
  for (FactorProblem::Block& block : problem->blocks) {
    if (!block.is_constant) evaluate.parameter_blocks.push_back(block.x.data());
  }
  ceres::CRSMatrix crs;
  if (!ceres_problem->Evaluate(evaluate, nullptr, nullptr, nullptr, &crs)) {
    throw InputError(
        "covariance: a factor cannot be evaluated at these blocks");
  }
  return InformationOf(crs);
}

}  // namespace

bool IsPose(const factors::BlockKind& kind) {
  return std::string_view(kind.name) == PoseBlock::kName;
}

const char* ToString(FactorSolverStatus status) {
  switch (status) {
    case FactorSolverStatus::kOk:
      return "ok";
    case FactorSolverStatus::kNotConverged:
      return "not_converged";
    case FactorSolverStatus::kFailed:
      return "failed";
  }
  return "";
}

FactorSolverSummary SolveFactors(const FactorSolverOptions& options,
                                 FactorProblem* problem) {
  FactorSolverSummary result;
  const auto ceres_problem = MakeCeresProblem(problem);
  // Otherwise Ceres writes to stderr.
  std::vector<double> gradient;
  if (!ceres_problem->Evaluate({}, &result.initial_cost, nullptr, &gradient,
                               nullptr)) {
    result.status = FactorSolverStatus::kFailed;
    result.reason = "a factor cannot be evaluated at the start";
    result.initial_cost = result.final_cost =
        std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  EndCallback end(options.is_interrupted);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.logging_type = ceres::SILENT;
  // With more threads Ceres adds up the cost in another order each time.
  solver.num_threads = 1;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = kTolerance;
  solver.parameter_tolerance = kTolerance;
  solver.gradient_tolerance = kTolerance;
  solver.callbacks.push_back(&end);
  solver.max_num_consecutive_invalid_steps = std::numeric_limits<int>::max();
  ceres::Solver::Summary summary;
  ceres::Solve(solver, ceres_problem.get(), &summary);

  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  // The first of them is the start, if it could be evaluated.
  result.iterations =
      std::max(static_cast<int>(summary.iterations.size()) - 1, 0);
  result.solve_ms = 1e3 * summary.total_time_in_seconds;
  if (!summary.IsSolutionUsable()) {
    result.status = FactorSolverStatus::kFailed;
    result.reason = summary.termination_type == ceres::USER_FAILURE
                        ? "no step leads to where the cost can be evaluated"
                        : "the solver failed: " + summary.message;
  } else if (summary.termination_type != ceres::CONVERGENCE) {
    result.status = FactorSolverStatus::kNotConverged;
    result.reason = "the cost still fell in iteration " +
                    std::to_string(result.iterations) + ", the last one";
  }
  return result;
}

Eigen::MatrixXd FactorCovariance(FactorProblem problem,
                                 const std::vector<int>& wanted) {
  // The first column of each block in J, and one more for the end.
  std::vector<int> first = {0};
  for (const FactorProblem::Block& block : problem.blocks) {
    first.push_back(first.back() + block.free());
  }
  // The column of each row of the result; -1 for what does not move.
  std::vector<int> columns;
  for (const int i : wanted) {
    for (int k = 0; k < problem.blocks[i].kind.tangent; ++k) {
      columns.push_back(problem.blocks[i].is_constant ? -1 : first[i] + k);
    }
  }
  const int size = static_cast<int>(columns.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  if (first.back() == 0) return covariance;
  const SparseInverse inverse(Information(&problem));
  if (!inverse.is_valid()) {
    throw InputError(
        "covariance: is singular: the factors do not determine all blocks; "
        "hold one with set_parameter_block_constant, or add a factor that "
        "measures what is missing");
  }
  for (int k = 0; k < size; ++k) {
    if (columns[k] < 0) continue;
    const Eigen::VectorXd column = inverse.Column(columns[k]);
    for (int i = 0; i < size; ++i) {
      if (columns[i] >= 0) covariance(i, k) = column[columns[i]];
    }
  }
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace rgbd_pose
