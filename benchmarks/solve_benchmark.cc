// One pose solve from matches, including building the problem, with every
// assembly and linear solver, compared with the same steps without Ceres.
//
// Names: solve/<assembly or plain>/<linear solver>/<loss>/<matches>,
// solve/<bare_loop or tiny_solver>/<loss>/<matches>,
// estimate/<assembly>/<loss>/<matches>.

#include <benchmark/benchmark.h>
#include <ceres/autodiff_cost_function.h>
#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/estimation/estimator.h"
#include "core/estimation/motion_cost.h"
#include "core/util/vector_lanes.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

constexpr char kCost[] = "bidirectional_point";
constexpr double kOutlierShare = 0.2;
constexpr int kMaxIterations = 50;
constexpr double kTolerance = 1e-6;  // Ceres' default

// Made once for each count and motion.
const Correspondences& Matches(int count, double max_motion) {
  static std::map<std::pair<int, double>, Correspondences> made;
  const auto [place, is_new] = made.try_emplace({count, max_motion});
  if (is_new) {
    RandomWorld world(1);
    place->second = world.Matches(count, kOutlierShare,
                                  world.Motion(max_motion, max_motion));
  }
  return place->second;
}

// Matches with a small motion, as from frame to frame, so one stage finds the
// motion: this compares the solves, not the graduation.
struct World {
  const Correspondences& matches;
  std::unique_ptr<MotionCost> cost;
  std::unique_ptr<ceres::LossFunction> loss;

  World(int count, const std::string& loss_name)
      : matches(Matches(count, 0.005)),
        cost(MakeCost(kCost)),
        loss(ParseLoss(loss_name).Make(cost->degrees_of_freedom())) {}
};

ceres::Problem::Options ProblemOptions(Assembly assembly) {
  ceres::Problem::Options options;
  options.cost_function_ownership = BlockOwnership(assembly);
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

// The reference for `autodiff`: BidirectionalPoint as a user would write it for
// ceres::AutoDiffCostFunction without this project, starting at motion 0.
struct PlainResidual {
  explicit PlainResidual(const Camera& camera, const Observation& o_prev,
                         const Observation& o_cur)
      : prev(camera, o_prev), cur(camera, o_cur) {}

  template <typename T>
  bool operator()(const T* x, T* r) const {
    using std::cos;
    using std::sin;
    const T sa = sin(x[0]), ca = cos(x[0]);
    const T sb = sin(x[1]), cb = cos(x[1]);
    const T sg = sin(x[2]), cg = cos(x[2]);
    const T R[3][3] = {
        {cb * cg, sa * sb * cg - ca * sg, ca * sb * cg + sa * sg},
        {cb * sg, sa * sb * sg + ca * cg, ca * sb * sg - sa * cg},
        {-sb, sa * cb, ca * cb}};
    const T* C = x + 3;
    const T d[3] = {prev.x[0] - C[0], prev.x[1] - C[1], prev.x[2] - C[2]};
    T e_c[3], e_p[3];
    for (int i = 0; i < 3; ++i) {
      e_c[i] = cur.x[i] - (R[i][0] * d[0] + R[i][1] * d[1] + R[i][2] * d[2]);
      e_p[i] = prev.x[i] - (R[0][i] * cur.x[0] + R[1][i] * cur.x[1] +
                            R[2][i] * cur.x[2] + C[i]);
    }
    cur.Whiten(e_c, r);
    prev.Whiten(e_p, r + 3);
    return true;
  }

  struct Point {
    Point(const Camera& camera, const Observation& o)
        : a((o.u - camera.cx) / camera.fx),
          b((o.v - camera.cy) / camera.fy),
          x{a * o.depth, b * o.depth, o.depth},
          w_u(0.5 * camera.fx / (o.depth * o.sigma_px)),
          w_v(0.5 * camera.fy / (o.depth * o.sigma_px)),
          w_z(0.5 / o.sigma_depth) {}

    template <typename T>
    void Whiten(const T* e, T* r) const {
      r[0] = w_u * (e[0] - a * e[2]);
      r[1] = w_v * (e[1] - b * e[2]);
      r[2] = w_z * e[2];
    }

    double a, b, x[3], w_u, w_v, w_z;
  };

  Point prev, cur;
};

void AddPlainBlocks(const World& world, double* x, ceres::Problem* problem) {
  const Correspondences& matches = world.matches;
  for (size_t i = 0; i < matches.size(); ++i) {
    problem->AddResidualBlock(
        new ceres::AutoDiffCostFunction<PlainResidual, 6, 6>(new PlainResidual(
            matches.camera(), matches[i].prev, matches[i].cur)),
        world.loss.get(), x);
  }
}

// With an assembly or, without one, with the plain blocks.
void SolveWithCeres(benchmark::State& state, std::optional<Assembly> assembly,
                    ceres::LinearSolverType linear, const std::string& loss) {
  World world(static_cast<int>(state.range(0)), loss);
  const LinearizationPoint origin;
  ceres::Solver::Options options;
  options.linear_solver_type = linear;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = kMaxIterations;
  options.function_tolerance = kTolerance;
  ceres::Solver::Summary summary;
  for (auto _ : state) {
    MotionVector x = MotionVector::Zero();
    ceres::Problem problem(
        ProblemOptions(assembly.value_or(Assembly::kAutodiff)));
    if (assembly) {
      world.cost->Bind({&world.matches});
      world.cost->Associate(Rigid3d());
      world.cost->AddTo(*assembly, origin, world.loss.get(), x.data(),
                        &problem);
    } else {
      AddPlainBlocks(world, x.data(), &problem);
    }
    ceres::Solve(options, &problem, &summary);
    benchmark::DoNotOptimize(x);
  }
  // Ceres counts the evaluation at the start as a Jacobian evaluation.
  state.counters["evaluations"] = summary.num_residual_evaluations + 1;
}

#if defined(__x86_64__)
// The compressed block without wide vectors.
void SolveBySse2(benchmark::State& state, const std::string& loss) {
  packed::InstructionSet& chosen = packed::ChosenInstructionSet();
  const packed::InstructionSet best =
      std::exchange(chosen, packed::InstructionSet::kBaseline);
  SolveWithCeres(state, Assembly::kCompressed, ceres::DENSE_NORMAL_CHOLESKY,
                 loss);
  chosen = best;
}
#endif

// The upper limit: Gauss-Newton on the same sums without Ceres.
void BareLoop(benchmark::State& state, const std::string& loss) {
  World world(static_cast<int>(state.range(0)), loss);
  const LinearizationPoint origin;
  int evaluations = 0;
  for (auto _ : state) {
    MotionVector x = MotionVector::Zero();
    world.cost->Bind({&world.matches});
    world.cost->Associate(Rigid3d());
    double last_cost = 0.0;
    for (evaluations = 1; evaluations <= kMaxIterations; ++evaluations) {
      NormalEquations sum;
      world.cost->Linearise(origin.DerivativesAt(x.data()), world.loss.get(),
                            &sum);
      if (evaluations > 1 &&
          std::abs(last_cost - sum.cost) <= kTolerance * last_cost) {
        break;
      }
      last_cost = sum.cost;
      x -= sum.hessian.ldlt().solve(sum.gradient);
    }
    benchmark::DoNotOptimize(x);
  }
  state.counters["evaluations"] = evaluations;
}

// The compressed block with the interface of ceres::TinySolver.
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
  World world(static_cast<int>(state.range(0)), loss);
  const LinearizationPoint origin;
  for (auto _ : state) {
    MotionVector x = MotionVector::Zero();
    world.cost->Bind({&world.matches});
    world.cost->Associate(Rigid3d());
    ceres::Problem problem(ProblemOptions(Assembly::kCompressed));
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

// A whole estimate with default options: graduation, covariance, inliers.
void Estimate(benchmark::State& state, Assembly assembly,
              const std::string& loss) {
  const Correspondences& matches =
      Matches(static_cast<int>(state.range(0)), 0.02);
  EstimatorOptions options;
  options.assembly = assembly;
  Estimator estimator(options, MakeRobustCosts(kCost, loss));
  MotionEstimate estimate;
  for (auto _ : state) {
    estimator.Estimate({&matches}, Rigid3d(), &estimate);
    benchmark::DoNotOptimize(estimate.cur_from_prev);
  }
  state.counters["iterations"] = estimate.iterations;
}

template <typename Run, typename... Args>
void Register(const std::string& name, int matches, Run run, Args... args) {
  benchmark::RegisterBenchmark(name.c_str(), run, args...)->Arg(matches);
}

void RegisterSize(int matches, const std::string& loss) {
  using Named = std::pair<const char*, std::optional<Assembly>>;
  for (const auto& [assembly_name, assembly] :
       {Named("compressed", Assembly::kCompressed),
        Named("per_match", Assembly::kPerMatch),
        Named("autodiff", Assembly::kAutodiff), Named("plain", {})}) {
    for (const auto& [linear_name, linear] :
         {std::pair("qr", ceres::DENSE_QR),
          std::pair("cholesky", ceres::DENSE_NORMAL_CHOLESKY)}) {
      Register(std::string("solve/") + assembly_name + "/" + linear_name + "/" +
                   loss,
               matches, SolveWithCeres, assembly, linear, loss);
    }
  }
#if defined(__x86_64__)
  Register("solve/compressed_sse2/cholesky/" + loss, matches, SolveBySse2,
           loss);
#endif
  Register("solve/tiny_solver/" + loss, matches, SolveWithTinySolver, loss);
  Register("solve/bare_loop/" + loss, matches, BareLoop, loss);
}

const bool kRegistered = [] {
  for (const int matches : {30, 100, 300, 1000, 10000, 100000}) {
    RegisterSize(matches, "huber");
    Register("estimate/compressed/tukey", matches, Estimate,
             Assembly::kCompressed, "tukey");
  }
  RegisterSize(300, "none");
  RegisterSize(300, "tukey");
  Register("estimate/per_match/tukey", 300, Estimate, Assembly::kPerMatch,
           "tukey");
  Register("estimate/autodiff/tukey", 300, Estimate, Assembly::kAutodiff,
           "tukey");
  return true;
}();

}  // namespace
}  // namespace rgbd_pose
