#include "core/pose_graph/pose_graph.h"

#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/pose_graph/graph_blocks.h"
#include "core/pose_graph/graph_problem.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// Each stage of a graduation narrows losses by this factor. They start no wider
// than so many times their widths: beyond that even least squares is no help.
constexpr double kNarrowing = 2.0;
constexpr double kWidest = 1024.0;

// A stage before the last one need not settle.
constexpr int kGraphIterationsPerEarlyStage = 3;

}  // namespace

std::string PoseGraphOptions::Check() const {
  if (max_rounds < 1) return "max_rounds must be at least 1";
  if (!(step_tolerance > 0.0)) return "step_tolerance must be positive";
  if (max_iterations < 1) return "max_iterations must be at least 1";
  if (!(max_standard_deviation > 0.0)) {
    return "max_standard_deviation must be positive";
  }
  if (threads < 1) return "threads must be at least 1";
  return "";
}

const char* ToString(GraphStatus status) {
  switch (status) {
    case GraphStatus::kOk:
      return "ok";
    case GraphStatus::kBadInput:
      return "bad_input";
    case GraphStatus::kNotAnchored:
      return "not_anchored";
    case GraphStatus::kSingular:
      return "singular";
    case GraphStatus::kNotConverged:
      return "not_converged";
  }
  return "";
}

class PoseGraph::Impl {
 public:
  explicit Impl(const PoseGraphOptions& options) : options_(options) {
    const std::string error = options.Check();
    if (!error.empty()) throw InputError("motion graph: " + error);
  }

  GraphSolution Solve();
  GraphProblem Problem(double width = 1.0) const {
    return GraphProblem(graph_, width);
  }

  const PoseGraphOptions options_;
  GraphTerms graph_;

 private:
  // The least width of the losses, in theirs, at which all edges count.
  double FirstWidth() const;
  // One round at a width of the losses; by how much a pose moved at most (rad
  // and m), or NaN if the solver gave up.
  double Round(double width, int max_iterations, GraphSolution* solution);
};

double PoseGraph::Impl::FirstWidth() const {
  double largest = 0.0;
  for (const GraphTerms::Edge& edge : graph_.edges) {
    if (edge.loss != nullptr && !graph_.IsIdle(edge.ref, edge.cur)) {
      largest = std::max(largest, graph_.SquaredMahalanobisDistance(edge));
    }
  }
  return std::clamp(std::sqrt(largest), 1.0, kWidest);
}

double PoseGraph::Impl::Round(double width, int max_iterations,
                              GraphSolution* solution) {
  GraphProblem problem = Problem(width);
  if (problem.is_empty()) return 0.0;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_iterations;
  options.num_threads = options_.threads;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-9;
  // An origin is near by: steps need no damping to begin with.
  options.initial_trust_region_radius = 1e8;
  ceres::Solver::Summary summary;
  problem.Solve(options, &summary);
  solution->iterations += static_cast<int>(summary.iterations.size());
  ++solution->rounds;
  solution->final_cost = summary.final_cost;
  if (!summary.IsSolutionUsable()) {
    solution->status = GraphStatus::kNotConverged;
    solution->reason = "the solver gave up: " + summary.message;
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

GraphSolution PoseGraph::Impl::Solve() {
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
  solution.initial_cost = solution.final_cost = Problem().Cost();
  if (options_.graduated) {
    for (double width = FirstWidth(); width > 1.0; width /= kNarrowing) {
      if (std::isnan(Round(width, kGraphIterationsPerEarlyStage, &solution)))
        break;
    }
  }
  for (int round = 0; round < options_.max_rounds && solution.ok(); ++round) {
    const double moved = Round(1.0, options_.max_iterations, &solution);
    if (!(moved > options_.step_tolerance)) break;
  }
  if (solution.ok()) {
    GraphProblem problem = Problem();
    is_refused(
        FindUndetermined(graph_, options_.max_standard_deviation, &problem),
        GraphStatus::kSingular);
  }
  if (!solution.ok()) graph_.poses = before;
  return solution;
}

PoseGraph::PoseGraph(const PoseGraphOptions& options)
    : impl_(std::make_unique<Impl>(options)) {}
PoseGraph::~PoseGraph() = default;
PoseGraph::PoseGraph(PoseGraph&&) noexcept = default;
PoseGraph& PoseGraph::operator=(PoseGraph&&) noexcept = default;

int PoseGraph::AddPose(const Rigid3d& world_from_cam, bool is_fixed) {
  impl_->graph_.poses.push_back({world_from_cam, is_fixed});
  return num_poses() - 1;
}

int PoseGraph::AddEdge(const RelativePose& edge,
                       const ceres::LossFunction* loss) {
  // A covariance without an inverse has no finite root either.
  impl_->graph_.edges.push_back({edge.ref, edge.cur, edge.cur_from_ref,
                                 SqrtInformation(edge.covariance.inverse()),
                                 loss});
  return static_cast<int>(impl_->graph_.edges.size()) - 1;
}

void PoseGraph::SetPose(int pose, const Rigid3d& world_from_cam) {
  impl_->graph_.poses[pose].world_from_cam = world_from_cam;
}

void PoseGraph::SetFixed(int pose, bool is_fixed) {
  impl_->graph_.poses[pose].is_fixed = is_fixed;
}

GraphSolution PoseGraph::Solve() { return impl_->Solve(); }

int PoseGraph::num_poses() const {
  return static_cast<int>(impl_->graph_.poses.size());
}

const Rigid3d& PoseGraph::pose(int pose) const {
  return impl_->graph_.poses[pose].world_from_cam;
}

std::vector<MotionMatrix> PoseGraph::MarginalCovariances(
    const std::vector<int>& poses) const {
  return impl_->Problem().MarginalCovariances(poses, impl_->options_.threads);
}

double PoseGraph::OvercountingFactor() const {
  const auto motions = static_cast<double>(num_poses() - 1);
  const auto edges = static_cast<double>(impl_->graph_.edges.size());
  return motions > 0.0 ? std::max(1.0, edges / motions) : 1.0;
}

}  // namespace rgbd_pose
