// Checks every hand-written Jacobian against automatic differentiation and
// against central differences, over random motions and matches.

#include <gflags/gflags.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

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
// Automatic differentiation differs only by rounding. Central differences also
// have an error of the order of the step squared plus rounding over the step.
constexpr double kJetTolerance = 1e-12;
constexpr double kDifferenceTolerance = 1e-5;
constexpr double kStep = 1e-5;

// A block of the Jacobian: one row of the residual by the angles or the centre.
struct Block {
  std::string name;
  double jet = 0.0;
  double differences = 0.0;
};

template <typename Residual>
class Checker {
 public:
  using Jacobian = Eigen::Matrix<double, Residual::kRows, 6, Eigen::RowMajor>;
  using Rows = Eigen::Matrix<double, Residual::kRows, 1>;

  // The largest errors over all samples, with a block for each row and each
  // half of the columns.
  std::vector<Block> Run() {
    std::vector<Block> blocks;
    for (int row = 0; row < Residual::kRows; ++row) {
      blocks.push_back({"row " + std::to_string(row) + ", angles"});
      blocks.push_back({"row " + std::to_string(row) + ", centre"});
    }
    RandomWorld world(FLAGS_seed);
    for (int i = 0; i < FLAGS_samples; ++i) {
      const ResidualSample<Residual> sample(&world);
      const Jacobian by_hand = Evaluate(
          AnalyticBlock<Residual>(sample.origin, sample.columns), sample.x);
      const Jacobian by_jet =
          Evaluate(OracleBlock<Residual>(new OracleFunctor<Residual>(
                       sample.origin, sample.columns)),
                   sample.x);
      const Jacobian by_differences = Differences(sample);
      for (int row = 0; row < Residual::kRows; ++row) {
        for (int half = 0; half < 2; ++half) {
          Block& block = blocks[2 * row + half];
          block.jet = std::max(block.jet, Error(by_hand, by_jet, row, half));
          block.differences = std::max(
              block.differences, Error(by_hand, by_differences, row, half));
        }
      }
    }
    return blocks;
  }

 private:
  static Jacobian Evaluate(const ceres::CostFunction& function,
                           const MotionVector& x) {
    const double* parameters[] = {x.data()};
    Rows residuals;
    Jacobian jacobian;
    double* jacobians[] = {jacobian.data()};
    function.Evaluate(parameters, residuals.data(), jacobians);
    return jacobian;
  }

  static Jacobian Differences(const ResidualSample<Residual>& sample) {
    Jacobian jacobian;
    for (int k = 0; k < 6; ++k) {
      MotionVector low = sample.x, high = sample.x;
      low[k] -= kStep;
      high[k] += kStep;
      Rows r_low, r_high;
      Residual::Residual(sample.origin.PoseAt(low.data()), sample.columns,
                         r_low.data());
      Residual::Residual(sample.origin.PoseAt(high.data()), sample.columns,
                         r_high.data());
      jacobian.col(k) = (r_high - r_low) / (2.0 * kStep);
    }
    return jacobian;
  }

  static double Error(const Jacobian& actual, const Jacobian& expected, int row,
                      int half) {
    const double size = expected.row(row).template lpNorm<Eigen::Infinity>();
    const double error = (actual.row(row) - expected.row(row))
                             .template segment<3>(3 * half)
                             .template lpNorm<Eigen::Infinity>();
    return size > 0.0 ? error / size : error;
  }
};

template <typename Residual>
bool Report() {
  if (!FLAGS_cost.empty() && FLAGS_cost != Residual::kName) return true;
  bool passed = true;
  for (const Block& block : Checker<Residual>().Run()) {
    const bool good =
        block.jet <= kJetTolerance && block.differences <= kDifferenceTolerance;
    std::printf("%-20s %-16s %12.1e %12.1e  %s\n", Residual::kName,
                block.name.c_str(), block.jet, block.differences,
                good ? "ok" : "WRONG");
    passed = passed && good;
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
          {{"cost", CostNames()}}};
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info(), rgbd_pose::Main);
}
