#pragma once

#include <ceres/loss_function.h>

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/python/any_factor.h"
#include "core/factors/check_factor.h"

namespace rgbd_pose {

// Whether a block has the tangent of poses.
bool IsPose(const factors::BlockKind& kind);

// Factors over blocks, as plain values: a copy can be solved by another thread.
struct FactorProblem {
  // A parameter block.
  struct Block {
    factors::BlockKind kind;
    std::vector<double> x;  // its numbers
    bool is_constant = false;

    // Dimensions in which a solve moves it.
    int free() const { return is_constant ? 0 : kind.tangent; }
  };

  // A factor over some of the blocks.
  struct Term {
    AnyFactor factor;
    std::shared_ptr<ceres::LossFunction> loss;  // null: least squares
    std::vector<int> blocks;                    // their indices
  };

  std::vector<Block> blocks;
  std::vector<Term> terms;
};

// How a problem is solved.
struct FactorSolverOptions {
  int max_iterations = 100;

  // Asked after each iteration; true ends the solve, whose steps are lost.
  std::function<bool()> is_interrupted = [] { return false; };
};

// How it went.
enum class FactorSolverStatus {
  kOk,
  kNotConverged,  // steps still reduced the cost at the last iteration
  kFailed,        // no step could be taken; the blocks are unchanged
};
const char* ToString(FactorSolverStatus status);

struct FactorSolverSummary {
  FactorSolverStatus status = FactorSolverStatus::kOk;
  std::string reason;  // empty if ok
  // Half the sum of squares, under the losses; NaN if it cannot be evaluated.
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;
  double solve_ms = 0.0;

  bool ok() const { return status == FactorSolverStatus::kOk; }
};

// Moves the blocks to a minimum of the cost near them.
FactorSolverSummary SolveFactors(const FactorSolverOptions& options,
                                 FactorProblem* problem);

// The joint covariance of some blocks in their tangents, in the order of their
// indices: of Gauss and Newton at the present blocks, zero for constant ones.
// Throws InputError if the factors do not determine all blocks of the problem.
Eigen::MatrixXd FactorCovariance(FactorProblem problem,
                                 const std::vector<int>& wanted);

}  // namespace rgbd_pose
