#include "core/pose_graph/graph_problem.h"

#include <cmath>

#include "core/factors/factor.h"
#include "core/factors/pose_manifold.h"
#include "core/factors/relative_pose.h"
#include "core/pose_graph/spanning_tree.h"
#include "core/util/small_matrix.h"

namespace rgbd_pose {

GraphProblem::GraphProblem(const GraphTerms& graph, double width) {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  // PoseGraph::Solve checks the input.
  options.disable_all_safety_checks = true;
  problem_ = std::make_unique<ceres::Problem>(options);
  x_.reserve(graph.poses.size());  // must not move
  int columns = 0;
  // Belongs to the problem, but only with a pose.
  auto* const manifold = graph.poses.empty() ? nullptr : new PoseManifold();
  for (const GraphTerms::Pose& pose : graph.poses) {
    double* const x = x_.emplace_back(PoseVectorOf(pose.world_from_cam)).data();
    AddPose(x, problem_.get(), manifold);
    if (pose.is_fixed) {
      problem_->SetParameterBlockConstant(x);
      columns_.push_back(-1);
    } else {
      columns_.push_back(columns);
      columns += PoseBlock::kTangent;
    }
  }
  for (const GraphTerms::Edge& edge : graph.edges) {
    if (graph.IsIdle(edge.ref, edge.cur)) continue;
    ceres::LossFunction* loss = nullptr;
    if (edge.loss != nullptr) loss = &losses_.emplace_back(edge.loss, width);
    problem_->AddResidualBlock(
        MakeFactor(RelativePoseFactor{edge.cur_from_ref, edge.root}), loss,
        x_[edge.ref].data(), x_[edge.cur].data());
  }
  for (const GraphTerms::Direction& direction : graph.directions) {
    if (graph.IsIdle(direction.a, direction.b)) continue;
    ceres::LossFunction* loss = nullptr;
    if (direction.loss != nullptr) {
      loss = &losses_.emplace_back(direction.loss, width);
    }
    problem_->AddResidualBlock(MakeFactor(direction.factor), loss,
                               x_[direction.a].data(), x_[direction.b].data());
  }
}

double GraphProblem::norm() const {
  double sum = 0.0;
  for (size_t i = 0; i < x_.size(); ++i) {
    if (columns_[i] >= 0) sum += x_[i].squaredNorm();
  }
  return std::sqrt(sum);
}

Eigen::SparseMatrix<double> GraphProblem::Information() {
  ceres::Problem::EvaluateOptions evaluate;
  for (size_t i = 0; i < x_.size(); ++i) {
    if (columns_[i] >= 0) evaluate.parameter_blocks.push_back(x_[i].data());
  }
  ceres::CRSMatrix crs;
  problem_->Evaluate(evaluate, nullptr, nullptr, nullptr, &crs);
  return InformationOf(crs);
}

MotionMatrix GraphProblem::CovarianceOf(const SparseInverse& inverse, int a,
                                        int b) const {
  MotionMatrix covariance = MotionMatrix::Zero();
  if (IsConstant(a) || IsConstant(b)) return covariance;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 6; ++k) {
      covariance(i, k) = inverse(columns_[a] + i, columns_[b] + k);
    }
  }
  return covariance;
}

int GraphProblem::FindUndetermined(const GraphTerms& graph,
                                   double max_standard_deviation) {
  const double limit = max_standard_deviation * max_standard_deviation;
  // First what an edge says by itself: that is at least as uncertain, and most
  // graphs need no more.
  std::vector<bool> is_determined;
  MotionVector r;
  RelativePoseFactor::ByPose by_ref, by_cur;
  for (const GraphTerms::Edge& edge : graph.edges) {
    RelativePoseFactor{edge.cur_from_ref, edge.root}.Jacobian(
        PoseAt(edge.ref), PoseAt(edge.cur), r.data(), &by_ref, &by_cur);
    double rho[3] = {0.0, 1.0, 0.0};
    if (edge.loss != nullptr) edge.loss->Evaluate(r.squaredNorm(), rho);
    const MotionMatrix information = rho[1] * by_cur.transpose() * by_cur;
    is_determined.push_back(EigenOf(information).eigenvalues()[0] * limit >= 1);
  }
  const int outside = FirstOutside(SpanningTree(graph, is_determined), graph);
  if (outside < 0) return -1;
  // Then what all edges say together. A weak prior makes the covariance of what
  // has no information large instead of infinite.
  constexpr double kPrior = 1e-6;
  Eigen::SparseMatrix<double> information = Information();
  information.diagonal().array() += kPrior / limit;
  const SparseInverse inverse(information);
  if (!inverse.is_valid()) return outside;
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    if (is_determined[i]) continue;
    const int ref = graph.edges[i].ref, cur = graph.edges[i].cur;
    // The motion between the poses as a function of them.
    const Rigid3d motion = WorldFromCam(cur).Inverse() * WorldFromCam(ref);
    RelativePoseFactor{motion, MotionMatrix::Identity()}.Jacobian(
        PoseAt(ref), PoseAt(cur), r.data(), &by_ref, &by_cur);
    Eigen::Matrix<double, 6, 12> J;
    J << by_ref, by_cur;
    Eigen::Matrix<double, 12, 12> covariance;
    covariance << CovarianceOf(inverse, ref, ref),
        CovarianceOf(inverse, ref, cur), CovarianceOf(inverse, cur, ref),
        CovarianceOf(inverse, cur, cur);
    is_determined[i] =
        EigenOf(J * covariance * J.transpose()).eigenvalues()[5] <= limit;
  }
  return FirstOutside(SpanningTree(graph, is_determined), graph);
}

std::vector<MotionMatrix> GraphProblem::MarginalCovariances(
    const std::vector<int>& poses) {
  std::vector<MotionMatrix> result(poses.size(), MotionMatrix::Zero());
  if (is_empty()) return result;
  const SparseInverse inverse(Information());
  if (!inverse.is_valid()) return {};
  result.clear();
  for (const int pose : poses) {
    result.push_back(PoseCovariance(CovarianceOf(inverse, pose, pose)));
  }
  return result;
}

}  // namespace rgbd_pose
