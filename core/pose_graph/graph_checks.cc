#include "core/pose_graph/graph_checks.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>
#include <vector>

namespace rgbd_pose {
namespace {

std::string NameOf(int pose) { return "pose " + std::to_string(pose); }

}  // namespace

std::string FindBadInput(const GraphTerms& graph) {
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    if (graph.poses[i].world_from_cam.IsFinite()) continue;
    return NameOf(static_cast<int>(i)) + " is not finite";
  }
  for (const GraphTerms::Edge& edge : graph.edges) {
    const std::string name =
        "the edge from " + NameOf(edge.ref) + " to " + NameOf(edge.cur);
    if (!graph.Has(edge.ref) || !graph.Has(edge.cur) || edge.ref == edge.cur) {
      return name + " is not between two poses of the graph";
    }
    if (!edge.cur_from_ref.IsFinite()) {
      return name + " has a motion that is not finite";
    }
    if (!edge.root.allFinite())
      return name + " has a covariance that is not positive definite";
  }
  return "";
}

// Poses that hang together, by the smallest number among them (union-find); all
// that are fixed hang together.
std::string FindUnanchoredPose(const GraphTerms& graph) {
  std::vector<int> root(graph.poses.size());
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
  const int poses = static_cast<int>(graph.poses.size());
  int fixed = -1;
  for (int i = 0; i < poses; ++i) {
    if (!graph.poses[i].is_fixed) continue;
    if (fixed >= 0) join(fixed, i);
    fixed = i;
  }
  for (int i = 0; i < poses; ++i) {
    if (fixed >= 0 && find(i) == find(fixed)) continue;
    return NameOf(i) + " and those joined to it hang on nothing that is fixed";
  }
  return "";
}

// The pivots of a Cholesky decomposition are the information of one parameter,
// those eliminated before it taken as unknown and those after as known: an
// upper limit of what is known of it, reached by the last.
std::string FindUndetermined(const GraphTerms& graph,
                             double max_standard_deviation,
                             GraphProblem* problem) {
  if (problem->is_empty()) return "";
  std::vector<int> free;  // the pose of each six columns
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    if (!graph.poses[i].is_fixed) free.push_back(static_cast<int>(i));
  }
  const ceres::CRSMatrix crs = problem->Jacobian(free);
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
  const Eigen::Map<const Sparse> J(
      crs.num_rows, crs.num_cols, static_cast<int>(crs.values.size()),
      crs.rows.data(), crs.cols.data(), crs.values.data());
  const Eigen::SparseMatrix<double> H = J.transpose() * J;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(H);
  const double least = 1.0 / (max_standard_deviation * max_standard_deviation);
  const Eigen::VectorXd pivots = ldlt.vectorD();
  for (int k = 0; k < pivots.size(); ++k) {
    if (ldlt.info() == Eigen::Success && pivots[k] >= least) continue;
    const int column = ldlt.permutationPinv().indices()[k];
    return NameOf(free[column / 6]) + " is not determined";
  }
  return "";
}

}  // namespace rgbd_pose
