#include "core/pose_graph/pose_graph.h"

#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/factors/relative_pose.h"
#include "core/factors/sqrt_information.h"
#include "core/pose_graph/graph_problem.h"
#include "core/pose_graph/spanning_tree.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// Graduation narrows the losses by this factor, from at most kWidest.
constexpr double kNarrowing = 2.0;
constexpr double kWidest = 1024.0;

// What one edge may cost more by chance: half of the 99.9 % quantile of chi^2
// with six degrees of freedom.
constexpr double kLeastGain = 11.23;

// Stages before the last one need not converge.
constexpr int kGraphIterationsPerEarlyStage = 3;
constexpr int kGraphIterationsPerRound = 30;

// The smallest factor on the widths of the losses at which all edges count.
double FirstWidth(const GraphTerms& graph) {
  double largest = 0.0;
  for (const GraphTerms::Edge& edge : graph.edges) {
    if (edge.loss == nullptr || graph.IsIdle(edge.ref, edge.cur)) continue;
    MotionVector r;
    RelativePoseFactor{edge.cur_from_ref, edge.root}.Residual(
        PoseFrom(graph.poses[edge.ref].world_from_cam),
        PoseFrom(graph.poses[edge.cur].world_from_cam), r.data());
    largest = std::max(largest, r.squaredNorm());
  }
  return std::clamp(std::sqrt(largest), 1.0, kWidest);
}

// Half the sum of squares under the losses, which are widened by `width`.
double CostOf(const GraphTerms& graph, double width) {
  double cost = 0.0;
  GraphProblem(graph, width)
      .problem()
      ->Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return cost;
}

std::string NameOf(int pose) { return "pose " + std::to_string(pose); }

constexpr double kRounding = 1e-6;  // of lengths in single precision

// What is wrong with a motion, or an empty text. A user may have set its
// members by hand.
std::string FaultOf(const Rigid3d& motion) {
  if (!motion.IsFinite()) return "is not finite";
  const double norm = motion.rotation.norm();
  if (std::abs(norm - 1.0) <= kRounding) return "";
  return "has a quaternion of length " + Format("%.7g", norm) + " instead of 1";
}

// One line on invalid values, or a measurement that is not between two poses;
// empty if there is nothing wrong.
std::string FindBadInput(const GraphTerms& graph) {
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    const std::string fault = FaultOf(graph.poses[i].world_from_cam);
    if (!fault.empty()) return NameOf(static_cast<int>(i)) + " " + fault;
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
    const std::string fault = FaultOf(edge.cur_from_ref);
    if (!fault.empty()) return name + " has a motion that " + fault;
    if (!edge.root.allFinite()) {
      return name + " has a covariance that is not positive definite";
    }
    constexpr double kAsymmetry = 1e-6;  // by rounding, as a share
    if (!edge.covariance.isApprox(edge.covariance.transpose(), kAsymmetry)) {
      return name + " has a covariance that is not symmetric";
    }
  }
  for (const GraphTerms::Direction& direction : graph.directions) {
    const int a = direction.a, b = direction.b;
    const std::string name =
        "the direction in " + NameOf(a) + " and " + NameOf(b);
    if (!has(a) || !has(b) || a == b) {
      return name + " is not one in two poses of the graph";
    }
    const CommonDirectionFactor& factor = direction.factor;
    for (const Eigen::Vector3d& end : {factor.in_a, factor.in_b}) {
      if (!(std::abs(end.norm() - 1.0) <= kRounding)) {
        return name + " is not of length 1";
      }
    }
    if (!(factor.sigma > 0.0) || !std::isfinite(factor.sigma)) {
      return name + " has a sigma that is not above 0";
    }
  }
  return "";
}

// A solve from some start: its poses, which are valid if it is ok.
struct Attempt {
  GraphTerms graph;
  GraphSolution solution;
};

// One solve with losses widened by `width`. Moves the poses of the attempt;
// returns the largest change (rad and m), or NaN if the solver gave up.
double Round(double width, int max_iterations, const PoseGraphOptions& options,
             Attempt* attempt) {
  GraphProblem problem(attempt->graph, width);
  if (problem.is_empty()) return 0.0;
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = max_iterations;
  solver.num_threads = 1;  // results may differ between numbers
  solver.logging_type = ceres::SILENT;
  // Steps of Gauss and Newton, damped only where one does not reduce the cost:
  // any damping holds the long waves of a long path back. What remains is 1e-12
  // of the information, also in directions without any: just above rounding.
  solver.initial_trust_region_radius = solver.max_trust_region_radius = 1e12;
  solver.min_lm_diagonal = 1.0;
  // Ceres drops the step that makes it stop; the first one of a round only if
  // it changes the cost by no more than rounding. So a round that moves poses
  // by less than the tolerance shows that they have arrived. Ceres compares a
  // step with the size of all parameters, and a quaternion moves by half the
  // angle.
  solver.parameter_tolerance = 0.5 * options.step_tolerance / problem.norm();
  solver.function_tolerance = 1e-14;
  solver.gradient_tolerance = 0.0;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, problem.problem(), &summary);
  GraphSolution& solution = attempt->solution;
  solution.iterations += summary.num_jacobian_evaluations;
  solution.final_cost = summary.final_cost;
  if (!summary.IsSolutionUsable()) {
    solution.status = GraphStatus::kNotConverged;
    solution.reason = "the solver failed: " + summary.message;
    return std::nan("");
  }
  double moved = 0.0;
  for (size_t i = 0; i < attempt->graph.poses.size(); ++i) {
    if (attempt->graph.poses[i].is_fixed) continue;
    Rigid3d* const pose = &attempt->graph.poses[i].world_from_cam;
    const Rigid3d before = *pose;
    *pose = problem.WorldFromCam(static_cast<int>(i));
    moved = std::max({moved, (before.Inverse() * *pose).Angle(),
                      (pose->translation - before.translation).norm()});
  }
  return moved;
}

// Solves with losses that are narrowed from a factor of `width` down to 1: from
// the poses of the graph, or from those of a tree of all poses if that costs
// less. `is_usable`: the edges that the tree may consist of.
Attempt Minimise(const GraphTerms& graph, const std::vector<bool>& is_usable,
                 double width, const PoseGraphOptions& options) {
  Attempt attempt{graph, {}};
  const std::vector<TreeNode> tree = SpanningTree(graph, is_usable);
  if (FirstOutside(tree, graph) < 0) {
    attempt.graph.poses = PosesByTree(tree, graph);
    if (!(CostOf(attempt.graph, width) < CostOf(graph, width))) {
      attempt.graph.poses = graph.poses;
    }
  }
  for (; width > 1.0 && attempt.solution.ok(); width /= kNarrowing) {
    Round(width, kGraphIterationsPerEarlyStage, options, &attempt);
  }
  double moved = std::numeric_limits<double>::infinity();
  for (int round = 0; round < options.max_rounds && attempt.solution.ok() &&
                      moved > options.step_tolerance;
       ++round) {
    moved = Round(1.0, kGraphIterationsPerRound, options, &attempt);
  }
  if (!attempt.solution.ok()) return attempt;
  if (moved > options.step_tolerance) {
    attempt.solution.status = GraphStatus::kNotConverged;
    attempt.solution.reason = "poses still moved by " + Format("%.2g", moved) +
                              " (rad or m) in round " +
                              std::to_string(options.max_rounds) +
                              ", the last one";
    return attempt;
  }
  const int pose =
      GraphProblem(attempt.graph, 1.0)
          .FindUndetermined(attempt.graph, options.max_standard_deviation);
  if (pose >= 0) {
    attempt.solution.status = GraphStatus::kSingular;
    attempt.solution.reason =
        NameOf(pose) +
        " is not determined: no path of motions with standard deviations of at "
        "most " +
        ShortNumber(options.max_standard_deviation) +
        " (rad, m) leads to a fixed pose";
  }
  return attempt;
}

}  // namespace

std::string PoseGraphOptions::Check() const {
  if (max_rounds < 1) return "max_rounds must be at least 1";
  if (!(step_tolerance > 0.0)) return "step_tolerance must be positive";
  if (!(max_standard_deviation > 0.0)) {
    return "max_standard_deviation must be positive";
  }
  return "";
}

PoseGraph::PoseGraph(const PoseGraphOptions& options) : options_(options) {
  RequireSound(options.Check(), "pose graph: ");
}

GraphSolution PoseGraph::Solve() {
  GraphSolution solution;
  const auto is_refused = [&](const std::string& reason, GraphStatus status) {
    if (reason.empty()) return false;
    solution.status = status;
    solution.reason = reason;
    return true;
  };
  if (is_refused(FindBadInput(graph_), GraphStatus::kBadInput)) return solution;
  const std::vector<bool> all(graph_.edges.size(), true);
  const int outside = FirstOutside(SpanningTree(graph_, all), graph_);
  if (is_refused(outside < 0
                     ? ""
                     : NameOf(outside) + " is not connected to any fixed pose",
                 GraphStatus::kNotAnchored)) {
    return solution;
  }
  // An edge with a loss may be wrong, and then all poses behind it.
  std::vector<bool> is_right;
  for (const auto& edge : graph_.edges)
    is_right.push_back(edge.loss == nullptr);
  Attempt best = Minimise(graph_, is_right, 1.0, options_);
  const double width = FirstWidth(graph_);
  if (options_.graduated && width > 1.0) {
    Attempt other = Minimise(graph_, is_right, width, options_);
    const int iterations = best.solution.iterations + other.solution.iterations;
    if (!best.solution.ok() ||
        (other.solution.ok() &&
         other.solution.final_cost + kLeastGain < best.solution.final_cost)) {
      best = std::move(other);
    }
    best.solution.iterations = iterations;
  }
  solution = best.solution;
  solution.initial_cost = CostOf(graph_, 1.0);
  if (solution.ok()) {
    graph_.poses = std::move(best.graph.poses);
  } else {
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
  for (const int pose : poses) {
    if (pose >= 0 && pose < num_poses()) continue;
    throw InputError(
        Format("pose graph: there is no pose %d among %d", pose, num_poses()));
  }
  return GraphProblem(graph_, 1.0).MarginalCovariances(poses);
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
