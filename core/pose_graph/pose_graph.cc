#include "core/pose_graph/pose_graph.h"

#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/pose_graph/graph_problem.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// Graduation narrows the losses by this factor, from at most kWidest.
constexpr double kNarrowing = 2.0;
constexpr double kWidest = 1024.0;

// Stages before the last one need not converge.
constexpr int kGraphIterationsPerEarlyStage = 3;
constexpr int kGraphIterationsPerRound = 30;

// The smallest factor on the widths of the losses at which all edges count.
double FirstWidth(const GraphTerms& graph) {
  double largest = 0.0;
  for (const GraphTerms::Edge& edge : graph.edges) {
    if (edge.loss == nullptr || graph.IsIdle(edge.ref, edge.cur)) continue;
    // The squared residual of the edge in sigmas.
    const Rigid3d motion = graph.poses[edge.cur].world_from_cam.Inverse() *
                           graph.poses[edge.ref].world_from_cam;
    largest =
        std::max(largest, RelativePoseErrorTerm(edge.cur_from_ref, edge.root)
                              .ResidualAt({motion.rotation.toRotationMatrix(),
                                           motion.Inverse().translation},
                                          nullptr)
                              .squaredNorm());
  }
  return std::clamp(std::sqrt(largest), 1.0, kWidest);
}

std::string NameOf(int pose) { return "pose " + std::to_string(pose); }

// The functions below return one line on why a graph cannot be solved, or an
// empty text. Here: invalid values, or an edge that does not connect two poses.
std::string FindBadInput(const GraphTerms& graph) {
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    if (graph.poses[i].world_from_cam.IsFinite()) continue;
    return NameOf(static_cast<int>(i)) + " is not finite";
  }
  const auto has = [&graph](int pose) {
    return pose >= 0 && pose < static_cast<int>(graph.poses.size());
  };
  for (const GraphTerms::Edge& edge : graph.edges) {
    const std::string name =
        "the edge from " + NameOf(edge.ref) + " to " + NameOf(edge.cur);
    if (!has(edge.ref) || !has(edge.cur) || edge.ref == edge.cur) {
      return name + " does not connect two poses of the graph";
    }
    if (!edge.cur_from_ref.IsFinite()) {
      return name + " has a motion that is not finite";
    }
    if (!edge.root.allFinite()) {
      return name + " has a covariance that is not positive definite";
    }
  }
  return "";
}

// A pose with no connection to a fixed pose. Groups connected poses by the
// smallest number among them (union-find); one more number stands for the world
// of all fixed ones.
std::string FindUnanchoredPose(const GraphTerms& graph) {
  const int world = static_cast<int>(graph.poses.size());
  std::vector<int> root(world + 1);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int pose) {
    while (root[pose] != pose) pose = root[pose] = root[root[pose]];
    return pose;
  };
  const auto join = [&](int a, int b) {
    a = find(a);
    b = find(b);
    root[std::max(a, b)] = std::min(a, b);
  };
  for (const GraphTerms::Edge& edge : graph.edges) join(edge.ref, edge.cur);
  for (int i = 0; i < world; ++i) {
    if (graph.poses[i].is_fixed) join(i, world);
  }
  for (int i = 0; i < world; ++i) {
    if (find(i) == find(world)) continue;
    return NameOf(i) + " is not connected to any fixed pose";
  }
  return "";
}

}  // namespace

std::string PoseGraphOptions::Check() const {
  if (max_rounds < 1) return "max_rounds must be at least 1";
  if (!(step_tolerance > 0.0)) return "step_tolerance must be positive";
  if (!(max_standard_deviation > 0.0)) {
    return "max_standard_deviation must be positive";
  }
  if (threads < 1) return "threads must be at least 1";
  return "";
}

PoseGraph::PoseGraph(const PoseGraphOptions& options) : options_(options) {
  RequireSound(options.Check(), "pose graph: ");
}

double PoseGraph::Round(double width, int max_iterations,
                        GraphSolution* solution) {
  GraphProblem problem(graph_, width);
  if (problem.is_empty()) return 0.0;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_iterations;
  options.num_threads = options_.threads;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-9;
  // The origin is close to the solution: no damping is needed at the start.
  options.initial_trust_region_radius = 1e8;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem.problem(), &summary);
  // The first entry is the start.
  solution->iterations +=
      std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  solution->final_cost = summary.final_cost;
  if (!summary.IsSolutionUsable()) {
    solution->status = GraphStatus::kNotConverged;
    solution->reason = "the solver failed: " + summary.message;
    return std::nan("");
  }
  double moved = 0.0;
  for (size_t i = 0; i < graph_.poses.size(); ++i) {
    if (graph_.poses[i].is_fixed) continue;
    const int pose = static_cast<int>(i);
    moved = std::max(moved, problem.parameters(pose).lpNorm<Eigen::Infinity>());
    graph_.poses[i].world_from_cam = problem.WorldFromCam(pose);
  }
  return moved;
}

GraphSolution PoseGraph::Solve() {
  GraphSolution solution;
  const auto is_refused = [&](const std::string& reason, GraphStatus status) {
    if (reason.empty()) return false;
    solution.status = status;
    solution.reason = reason;
    return true;
  };
  if (is_refused(FindBadInput(graph_), GraphStatus::kBadInput) ||
      is_refused(FindUnanchoredPose(graph_), GraphStatus::kNotAnchored)) {
    return solution;
  }
  const std::vector<GraphTerms::Pose> before = graph_.poses;
  GraphProblem(graph_, 1.0)
      .problem()
      ->Evaluate({}, &solution.initial_cost, nullptr, nullptr, nullptr);
  solution.final_cost = solution.initial_cost;
  if (options_.graduated) {
    for (double width = FirstWidth(graph_); width > 1.0; width /= kNarrowing) {
      if (std::isnan(Round(width, kGraphIterationsPerEarlyStage, &solution)))
        break;
    }
  }
  for (int round = 0; round < options_.max_rounds && solution.ok(); ++round) {
    const double moved = Round(1.0, kGraphIterationsPerRound, &solution);
    if (!(moved > options_.step_tolerance)) break;
  }
  if (solution.ok()) {
    const int pose = GraphProblem(graph_, 1.0)
                         .FindUndetermined(options_.max_standard_deviation);
    is_refused(pose < 0 ? "" : NameOf(pose) + " is not determined",
               GraphStatus::kSingular);
  }
  if (!solution.ok()) {
    graph_.poses = before;
    solution.final_cost = solution.initial_cost;
  }
  return solution;
}

void PoseGraph::AddEdge(const RelativePose& edge,
                        const ceres::LossFunction* loss) {
  // A covariance that is not invertible has no finite root either.
  graph_.edges.push_back(
      {edge, SqrtInformation(edge.covariance.inverse()), loss});
}

std::vector<MotionMatrix> PoseGraph::MarginalCovariances(
    const std::vector<int>& poses) const {
  return GraphProblem(graph_, 1.0).MarginalCovariances(poses, options_.threads);
}

double PoseGraph::OvercountingFactor() const {
  double motions = 0.0, edges = 0.0;
  for (const auto& pose : graph_.poses) motions += !pose.is_fixed;
  for (const auto& edge : graph_.edges) {
    edges += !graph_.IsIdle(edge.ref, edge.cur);
  }
  return motions > 0.0 ? std::max(1.0, edges / motions) : 1.0;
}

}  // namespace rgbd_pose
