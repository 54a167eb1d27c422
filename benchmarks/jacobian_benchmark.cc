// Residual and Jacobian of one match, with hand-written and with automatic
// derivatives, for every cost of the list: alone (the cost functions one after
// the other) and through ceres::Problem::Evaluate. The motion and its
// derivatives are computed for each match, as in any problem with one block per
// match.
//
// Names: jacobian/<alone or in_ceres>/<cost>/<analytic or autodiff>.

#include <benchmark/benchmark.h>
#include <ceres/crs_matrix.h>
#include <ceres/problem.h>

#include <memory>
#include <string>
#include <vector>

#include "core/geometry/motion.h"
#include "costs/assembly/cost_blocks.h"
#include "costs/cost_list.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

constexpr int kBlocks = 256;  // fits the cache, so arithmetic is measured

template <typename Residual>
struct Blocks {
  LinearizationPoint origin;
  std::vector<ResidualSample<Residual>> samples;
  std::vector<std::unique_ptr<ceres::CostFunction>> by_hand;
  std::vector<std::unique_ptr<ceres::CostFunction>> by_jet;

  Blocks() {
    RandomWorld world(1);
    samples.reserve(kBlocks);
    for (int i = 0; i < kBlocks; ++i) samples.emplace_back(&world);
    for (const auto& sample : samples) {
      by_hand.push_back(
          std::make_unique<AnalyticBlock<Residual>>(origin, sample.columns));
      by_jet.push_back(std::make_unique<OracleBlock<Residual>>(
          new OracleFunctor<Residual>{origin, sample.columns}));
    }
  }
};

template <typename Residual>
void Alone(benchmark::State& state, bool by_hand) {
  const Blocks<Residual> blocks;
  const auto& functions = by_hand ? blocks.by_hand : blocks.by_jet;
  MotionVector x;
  x << 0.01, -0.02, 0.015, 0.02, 0.01, -0.03;
  const double* parameters[] = {x.data()};
  double r[Residual::kRows], J[Residual::kRows * 6];
  double* jacobians[] = {J};
  for (auto _ : state) {
    for (const auto& function : functions) {
      function->Evaluate(parameters, r, jacobians);
      benchmark::DoNotOptimize(r);
      benchmark::DoNotOptimize(J);
    }
  }
  state.counters["calls"] = kBlocks;  // per iteration
}

template <typename Residual>
void InCeres(benchmark::State& state, bool by_hand) {
  const Blocks<Residual> blocks;
  const auto& functions = by_hand ? blocks.by_hand : blocks.by_jet;
  MotionVector x;
  x << 0.01, -0.02, 0.015, 0.02, 0.01, -0.03;
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  for (const auto& function : functions) {
    problem.AddResidualBlock(function.get(), nullptr, x.data());
  }
  double cost = 0.0;
  std::vector<double> residuals, gradient;
  ceres::CRSMatrix jacobian;
  for (auto _ : state) {
    problem.Evaluate({}, &cost, &residuals, &gradient, &jacobian);
    benchmark::DoNotOptimize(cost);
  }
  state.counters["calls"] = kBlocks;  // per iteration
}

template <typename... Residuals>
void RegisterAll(TypeList<Residuals...>) {
  const auto add = [](const std::string& what, const char* cost,
                      const char* how, auto run) {
    benchmark::RegisterBenchmark(
        ("jacobian/" + what + "/" + cost + "/" + how).c_str(), run);
  };
  (add("alone", Residuals::kName, "analytic",
       [](benchmark::State& s) { Alone<Residuals>(s, true); }),
   ...);
  (add("alone", Residuals::kName, "autodiff",
       [](benchmark::State& s) { Alone<Residuals>(s, false); }),
   ...);
  (add("in_ceres", Residuals::kName, "analytic",
       [](benchmark::State& s) { InCeres<Residuals>(s, true); }),
   ...);
  (add("in_ceres", Residuals::kName, "autodiff",
       [](benchmark::State& s) { InCeres<Residuals>(s, false); }),
   ...);
}

const bool kRegistered = [] {
  RegisterAll(ResidualTypes());
  return true;
}();

}  // namespace
}  // namespace rgbd_pose
