// Direct costs on rendered images: linearising rows, compared with a
// hand-written loop; looking up points; one row in Ceres, with hand-written and
// with automatic derivatives.
//
// Names: direct/linearise/<cost or bare_loop>/<rows>, direct/look_up/<cost>/
// <points>, jacobian/alone/<cost>/<analytic or autodiff>.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry/motion.h"
#include "costs/assembly/cost_blocks.h"
#include "costs/cost_list.h"
#include "robust/m_estimator.h"
#include "tests/support/direct_columns.h"

namespace rgbd_pose {
namespace {

constexpr int kRows = 10000;
constexpr int kBlocks = 256;  // as in jacobian_benchmark.cc

// Two consecutive frames of 640 x 480.
const DirectPair& Pair() {
  static const DirectPair pair = [] {
    SyntheticOptions options;
    options.path = "handheld";
    return DirectPair(SyntheticDataset(options), 10, 11);
  }();
  return pair;
}

// More points than the rows need: every texture is used.
template <typename Residual>
PackedColumns ManyPoints() {
  PackedColumns points;
  DirectOptions options;
  options.max_points = 6 * kRows;
  options.min_gradient = 0.0;
  Residual::Points(Pair().prev.view, 0, options, &points);
  return points;
}

template <typename Residual>
PackedColumns ManyRows() {
  PackedColumns rows = SeenColumns<Residual>(
      InputOf(Pair(), 0, Pair().cur_from_prev), ManyPoints<Residual>());
  if (rows.size < kRows) std::abort();
  rows.size = kRows;
  return rows;
}

MotionDerivatives Motion() {
  const MotionVector zero = MotionVector::Zero();
  return LinearizationPoint(Pair().cur_from_prev).DerivativesAt(zero.data());
}

std::unique_ptr<ceres::LossFunction> Huber() {
  return ParseLoss("huber").Make(1);
}

template <typename Residual>
void Linearise(benchmark::State& state) {
  const PackedColumns rows = ManyRows<Residual>();
  const MotionDerivatives motion = Motion();
  const auto huber = Huber();
  const ceres::LossFunction* const loss = huber.get();
  for (auto _ : state) {
    NormalEquations sum;
    NormalEquations* const out = &sum;
    RunVectorised<packed::LineariseKernel<Residual>>(motion, rows, loss, 0,
                                                     kRows, out);
    benchmark::DoNotOptimize(sum);
  }
}

// The upper limit: a single loop over Photometric's rows, with the same
// instruction set and Huber's weight inlined.
struct BareLoop {
  template <int W>
  [[gnu::always_inline]] static void Run(const MotionDerivatives& motion,
                                         const PackedColumns& rows,
                                         double width, NormalEquations* out) {
    using D = typename Lanes<W>::Type;
    const D one = D{} + 1.0, c = D{} + width;
    D H[21] = {}, g[6] = {}, cost = {};
    for (int i = 0; i < rows.size; i += W) {
      D m[6];
      for (int k = 0; k < 6; ++k) {
        std::memcpy(&m[k], &rows.values[k * rows.stride + i], sizeof(D));
      }
      const D d[3] = {m[0] - motion.C[0], m[1] - motion.C[1],
                      m[2] - motion.C[2]};
      D q[3];
      Multiply(motion.R, d, q);
      const D inverse = 1.0 / q[2];
      const D a = m[4] * inverse, b = m[5] * inverse;
      const D flow = a * q[0] + b * q[1];
      const D r = m[3] + flow;
      const D by_q[3] = {a, b, -flow * inverse};
      D J[6];
      for (int k = 0; k < 3; ++k) {
        D dq[3];
        Multiply(motion.dR[k], d, dq);
        J[k] = by_q[0] * dq[0] + by_q[1] * dq[1] + by_q[2] * dq[2];
        J[3 + k] = -(by_q[0] * motion.R(0, k) + by_q[1] * motion.R(1, k) +
                     by_q[2] * motion.R(2, k));
      }
      const D size = r < 0.0 ? -r : r;
      const D weight = size <= c ? one : c / size;
      cost += size <= c ? r * r : 2.0 * c * size - c * c;
      int entry = 0;
      for (int k = 0; k < 6; ++k) {
        const D wJ = weight * J[k];
        g[k] += wJ * r;
        for (int l = k; l < 6; ++l) H[entry++] += wJ * J[l];
      }
    }
    int entry = 0;
    for (int k = 0; k < 6; ++k) {
      for (int lane = 0; lane < W; ++lane) out->gradient[k] += g[k][lane];
      for (int l = k; l < 6; ++l, ++entry) {
        for (int lane = 0; lane < W; ++lane) {
          out->hessian(k, l) += H[entry][lane];
        }
        out->hessian(l, k) = out->hessian(k, l);
      }
    }
    for (int lane = 0; lane < W; ++lane) out->cost += 0.5 * cost[lane];
  }
};

void LineariseByHand(benchmark::State& state) {
  const PackedColumns rows = ManyRows<Photometric>();
  const MotionDerivatives motion = Motion();
  const double width = FindNamed(MEstimators(), "huber")->Width95(1);
  NormalEquations sum;
  for (auto _ : state) {
    sum = NormalEquations();
    NormalEquations* const out = &sum;
    RunVectorised<BareLoop>(motion, rows, width, out);
    benchmark::DoNotOptimize(sum);
  }
  // Both sums must be equal.
  const auto huber = Huber();
  const ceres::LossFunction* const loss = huber.get();
  NormalEquations expected;
  NormalEquations* const out = &expected;
  RunVectorised<packed::LineariseKernel<Photometric>>(motion, rows, loss, 0,
                                                      kRows, out);
  if ((sum.hessian - expected.hessian).norm() >
          1e-9 * expected.hessian.norm() ||
      std::abs(sum.cost - expected.cost) > 1e-9 * expected.cost) {
    state.SkipWithError("not the sum of the kernel");
  }
}

// With as many points as LineariseByHand has rows.
template <typename Residual>
void LookUp(benchmark::State& state) {
  PackedColumns points = ManyPoints<Residual>();
  points.size = std::min(points.size, kRows);
  const DirectInput input = InputOf(Pair(), 0, Pair().cur_from_prev);
  PackedColumns seen = SeenColumns<Residual>(input, points);
  PackedColumns* const out = &seen;
  for (auto _ : state) {
    RunVectorised<LookUpKernel<Residual>>(input, points, out);
    benchmark::DoNotOptimize(seen.values.data());
    benchmark::ClobberMemory();
  }
  state.counters["rows"] = seen.size;
}

template <typename Residual>
void Alone(benchmark::State& state, bool by_hand) {
  const PackedColumns rows = ManyRows<Residual>();
  const LinearizationPoint origin(Pair().cur_from_prev);
  std::vector<double> columns(kBlocks * Residual::kColumns);
  std::vector<std::unique_ptr<ceres::CostFunction>> functions;
  for (int i = 0; i < kBlocks; ++i) {
    double* const row = &columns[i * Residual::kColumns];
    for (int k = 0; k < Residual::kColumns; ++k) {
      row[k] = rows.values[k * rows.stride + i];
    }
    if (by_hand) {
      functions.push_back(
          std::make_unique<AnalyticBlock<Residual>>(origin, row));
    } else {
      functions.push_back(std::make_unique<OracleBlock<Residual>>(
          new OracleFunctor<Residual>{origin, row}));
    }
  }
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

void Register(const std::string& name, void (*run)(benchmark::State&)) {
  benchmark::RegisterBenchmark(name.c_str(), run);
}

template <typename... Residuals>
void RegisterAll(TypeList<Residuals...>) {
  const std::string rows = "/" + std::to_string(kRows);
  const auto cost = [](const char* name) { return std::string(name); };
  (Register("direct/linearise/" + cost(Residuals::kName) + rows,
            Linearise<Residuals>),
   ...);
  Register("direct/linearise/bare_loop" + rows, LineariseByHand);
  (Register("direct/look_up/" + cost(Residuals::kName) + rows,
            LookUp<Residuals>),
   ...);
  (Register("jacobian/alone/" + cost(Residuals::kName) + "/analytic",
            [](benchmark::State& s) { Alone<Residuals>(s, true); }),
   ...);
  (Register("jacobian/alone/" + cost(Residuals::kName) + "/autodiff",
            [](benchmark::State& s) { Alone<Residuals>(s, false); }),
   ...);
}

const bool kRegistered = [] {
  RegisterAll(DirectResidualTypes());
  return true;
}();

}  // namespace
}  // namespace rgbd_pose
