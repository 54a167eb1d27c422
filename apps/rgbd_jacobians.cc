// Checks every hand-written Jacobian against automatic differentiation and
// against central differences, over random motions and matches.

#include <gflags/gflags.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "apps/shell/program.h"
#include "core/geometry/motion.h"
#include "core/util/input_error.h"
#include "costs/assembly/cost_blocks.h"
#include "costs/cost_factory.h"
#include "costs/cost_list.h"
#include "frontend/simulation/synthetic_matches.h"

DEFINE_int32(samples, 1000, "random motions and matches for each cost");
DEFINE_uint32(seed, 1, "seed of the samples");
DEFINE_string(cost, "", "one cost; empty: all");

namespace rgbd_pose {
namespace {

// Tolerances for the largest errors, relative to the largest entry of the row.
// Central differences err by the step squared and the rounding over the step.
constexpr double kJetTolerance = 1e-12;
constexpr double kDifferenceTolerance = 1e-5;
constexpr double kStep = 1e-5;

using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

Jacobian Evaluate(const ceres::CostFunction& function, const MotionVector& x) {
  const double* parameters[] = {x.data()};
  Eigen::VectorXd residuals(function.num_residuals());
  Jacobian jacobian(function.num_residuals(), 6);
  double* jacobians[] = {jacobian.data()};
  function.Evaluate(parameters, residuals.data(), jacobians);
  return jacobian;
}

template <typename Residual>
Jacobian Differences(const ResidualSample<Residual>& sample) {
  const auto residuals_at = [&sample](int k, double step) {
    MotionVector x = sample.x;
    x[k] += step;
    Eigen::Matrix<double, Residual::kRows, 1> residuals;
    Residual::Residual(sample.origin.PoseAt(x.data()), sample.columns,
                       residuals.data());
    return residuals;
  };
  Jacobian jacobian(Residual::kRows, 6);
  for (int k = 0; k < 6; ++k) {
    jacobian.col(k) =
        (residuals_at(k, kStep) - residuals_at(k, -kStep)) / (2.0 * kStep);
  }
  return jacobian;
}

// The largest errors of each row: in the columns of the angles and in those of
// the centre. Infinite if an element is not finite.
using Errors = Eigen::ArrayX2d;

Errors ErrorsOf(const Jacobian& actual, const Jacobian& expected) {
  Errors errors(actual.rows(), 2);
  for (int row = 0; row < actual.rows(); ++row) {
    const double size = expected.row(row).lpNorm<Eigen::Infinity>();
    for (int half = 0; half < 2; ++half) {
      const Eigen::Vector3d off =
          (actual.row(row) - expected.row(row)).segment<3>(3 * half);
      const double error = off.lpNorm<Eigen::Infinity>();
      errors(row, half) =
          !off.allFinite() ? INFINITY : (size > 0.0 ? error / size : error);
    }
  }
  return errors;
}

template <typename Residual>
bool Report() {
  if (!FLAGS_cost.empty() && FLAGS_cost != Residual::kName) return true;
  Errors jet = Errors::Zero(Residual::kRows, 2);
  Errors differences = jet;
  RandomWorld world(FLAGS_seed);
  for (int i = 0; i < FLAGS_samples; ++i) {
    const ResidualSample<Residual> sample(&world);
    const Jacobian by_hand = Evaluate(
        AnalyticBlock<Residual>(sample.origin, sample.columns), sample.x);
    const Jacobian by_jet =
        Evaluate(OracleBlock<Residual>(new OracleFunctor<Residual>{
                     sample.origin, sample.columns}),
                 sample.x);
    jet = jet.max(ErrorsOf(by_hand, by_jet));
    differences = differences.max(ErrorsOf(by_hand, Differences(sample)));
  }
  bool passed = true;
  for (int row = 0; row < Residual::kRows; ++row) {
    for (int half = 0; half < 2; ++half) {
      const std::string block =
          "row " + std::to_string(row) + (half == 0 ? ", angles" : ", centre");
      const bool good = jet(row, half) <= kJetTolerance &&
                        differences(row, half) <= kDifferenceTolerance;
      std::printf("%-20s %-16s %12.1e %12.1e  %s\n", Residual::kName,
                  block.c_str(), jet(row, half), differences(row, half),
                  good ? "ok" : "WRONG");
      passed = passed && good;
    }
  }
  return passed;
}

template <typename... Residuals>
bool ReportAll(TypeList<Residuals...>) {
  bool passed = true;
  ((passed = Report<Residuals>() && passed), ...);
  return passed;
}

int Main() {
  if (FLAGS_samples < 1) throw InputError("--samples must be at least 1");
  if (FLAGS_cost.find('+') != std::string::npos) {
    throw InputError("--cost: must be one cost, or empty for all");
  }
  if (!FLAGS_cost.empty()) MakeRobustCosts(FLAGS_cost, "none");
  std::printf("%-20s %-16s %12s %12s\n", "cost", "block", "autodiff",
              "differences");
  const bool passed = ReportAll(ResidualTypes());
  std::printf(
      "\nworst errors over %d samples, relative to the row's largest entry; "
      "tolerances %.0e, %.0e\n",
      FLAGS_samples, kJetTolerance, kDifferenceTolerance);
  return passed ? kExitOk : kExitTrackingFailed;
}

ProgramInfo Info() {
  return {"rgbd_jacobians",
          "compares hand-written Jacobians with automatic differentiation and "
          "central differences; exit 3 if one is wrong.",
          "rgbd_jacobians --samples=1000",
          {{"What to check", {"cost", "samples", "seed"}}},
          /*settings=*/{},
          {{"cost", CostNames()}}};
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
