// Checks every hand-written Jacobian against automatic differentiation and
// against central differences, over random motions, matches and pixels.

#include <gflags/gflags.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "apps/jacobians/direct_jacobians.h"
#include "apps/shell/program.h"
#include "core/factors/check_factor.h"
#include "core/geometry/motion.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "costs/assembly/cost_blocks.h"
#include "costs/cost_factory.h"
#include "costs/cost_list.h"
#include "costs/direct_cost_factory.h"
#include "costs/factors/factor_list.h"
#include "frontend/simulation/synthetic_matches.h"

DEFINE_int32(samples, 1000,
             "random states for each cost and factor, or pixels");
DEFINE_uint32(seed, 1, "seed of the samples");
DEFINE_string(cost, "", "one cost, and no factor; empty: all");
DEFINE_string(factor, "", "one factor, and no cost; empty: all");

namespace rgbd_pose {
namespace {

// Tolerances for the largest errors, relative to the largest entry of the row.
// Central differences err by the step squared and the rounding over the step.
constexpr double kJetTolerance = 1e-12;
constexpr double kDifferenceTolerance = 1e-5;
constexpr double kStep = 1e-5;

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

// Prints one line, of a part of a Jacobian. Returns whether it is right.
bool PrintLine(const std::string& name, const std::string& part,
               double autodiff, double differences) {
  const bool good =
      autodiff <= kJetTolerance && differences <= kDifferenceTolerance;
  std::printf("%-20s %-24s %12.1e %12.1e  %s\n", name.c_str(), part.c_str(),
              autodiff, differences, good ? "ok" : "WRONG");
  return good;
}

// Whether a cost or a factor is to be checked; `other` is the flag of the other
// kind.
bool IsWanted(const std::string& flag, const std::string& other,
              const std::string& name) {
  return flag == name || (flag.empty() && other.empty());
}

// Prints the lines of a cost. Returns whether it is right.
bool PrintRows(const std::string& name, const Errors& autodiff,
               const Errors& differences) {
  bool passed = true;
  for (int row = 0; row < autodiff.rows(); ++row) {
    for (int half = 0; half < 2; ++half) {
      const std::string part =
          "row " + std::to_string(row) + (half == 0 ? ", angles" : ", centre");
      passed =
          PrintLine(name, part, autodiff(row, half), differences(row, half)) &&
          passed;
    }
  }
  return passed;
}

template <typename Residual>
bool ReportCost() {
  if (!IsWanted(FLAGS_cost, FLAGS_factor, Residual::kName)) return true;
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
  return PrintRows(Residual::kName, jet, differences);
}

// A direct cost, by its only row, over pixels.
bool ReportDirectCost(const std::string& name) {
  if (!IsWanted(FLAGS_cost, FLAGS_factor, name)) return true;
  constexpr int kMinPixels = 100;  // the other frame does not see all of them
  const JacobianInThreeWays pixels = JacobiansOfPixels(
      name, std::max(FLAGS_samples, kMinPixels), FLAGS_seed, kStep);
  return PrintRows(
      name, ErrorsOf(pixels.by_hand, pixels.by_autodiff).colwise().maxCoeff(),
      ErrorsOf(pixels.by_hand, pixels.by_differences).colwise().maxCoeff());
}

// The larger of two numbers, or infinity if one of them is not finite.
double Larger(double a, double b) {
  return std::isfinite(a) && std::isfinite(b) ? std::max(a, b) : INFINITY;
}

// The errors of a factor by each of its blocks, over random measurements and
// states.
bool ReportFactor(const ListedFactor& factor) {
  if (!IsWanted(FLAGS_factor, FLAGS_cost, factor.name)) return true;
  constexpr int kStatesEach = 10;  // of each measurement
  FactorSampler random(FLAGS_seed);
  std::vector<FactorErrors> worst;
  for (int done = 0; done < FLAGS_samples; done += kStatesEach) {
    CheckFactorOptions options;
    options.samples = std::min(kStatesEach, FLAGS_samples - done);
    // The states get other random numbers than the measurements: with the same
    // ones, a gravity would be along an axis of its pose, with rows of zeros.
    options.seed = FLAGS_seed + 1 + done;
    const auto errors = ErrorsOfFactor(factor.sample(&random), options);
    if (worst.empty()) worst = errors;
    for (size_t i = 0; i < errors.size(); ++i) {
      worst[i].autodiff = Larger(worst[i].autodiff, errors[i].autodiff);
      worst[i].differences =
          Larger(worst[i].differences, errors[i].differences);
    }
  }
  bool passed = true;
  for (size_t i = 0; i < worst.size(); ++i) {
    passed = PrintLine(factor.name,
                       "block " + std::to_string(i) + ", " + worst[i].block,
                       worst[i].autodiff, worst[i].differences) &&
             passed;
  }
  return passed;
}

template <typename... Residuals>
bool ReportCosts(TypeList<Residuals...> /*types*/) {
  bool passed = true;
  ((passed = ReportCost<Residuals>() && passed), ...);
  return passed;
}

// The names of all costs: over matches, then over pixels.
std::vector<std::string> AllCostNames() {
  std::vector<std::string> names = CostNames();
  for (const std::string& name : DirectCostNames()) names.push_back(name);
  return names;
}

std::vector<std::string> FactorNames() {
  std::vector<std::string> names;
  for (const ListedFactor& factor : ListedFactors()) {
    names.push_back(factor.name);
  }
  return names;
}

// Throws InputError for a name that is neither empty nor one of `names`.
void RequireKnown(const char* what, const std::string& name,
                  const std::vector<std::string>& names) {
  if (name.empty()) return;
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw UnknownName(what, name, names);
  }
}

int Main() {
  if (FLAGS_samples < 1) throw InputError("--samples must be at least 1");
  if (FLAGS_cost.find('+') != std::string::npos) {
    throw InputError("--cost: must be one cost, or empty for all");
  }
  RequireKnown("cost", FLAGS_cost, AllCostNames());
  RequireKnown("factor", FLAGS_factor, FactorNames());
  std::printf("%-20s %-24s %12s %12s\n", "cost or factor", "part", "autodiff",
              "differences");
  bool passed = ReportCosts(ResidualTypes());
  for (const std::string& name : DirectCostNames()) {
    passed = ReportDirectCost(name) && passed;
  }
  for (const ListedFactor& factor : ListedFactors()) {
    passed = ReportFactor(factor) && passed;
  }
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
          {{"What to check", {"cost", "factor", "samples", "seed"}}},
          /*settings=*/{},
          {{"cost", AllCostNames()}, {"factor", FactorNames()}}};
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
