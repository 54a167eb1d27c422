#include "core/pose_graph/graph_problem.h"

#include <ceres/covariance.h>

#include <utility>

#include "core/pose_graph/graph_blocks.h"

namespace rgbd_pose {

GraphProblem::GraphProblem(const GraphTerms& graph, double width)
    : x_(graph.poses.size(), MotionVector::Zero()) {
  origins_.reserve(graph.poses.size());
  for (const GraphTerms::Pose& pose : graph.poses) {
    origins_.emplace_back(pose.world_from_cam.Inverse());
  }
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;  // see FindBadInput
  problem_ = std::make_unique<ceres::Problem>(options);
  for (size_t i = 0; i < x_.size(); ++i) {
    if (!graph.poses[i].is_fixed) {
      problem_->AddParameterBlock(x_[i].data(), 6);
    }
  }
  for (const GraphTerms::Edge& edge : graph.edges) {
    if (!graph.IsIdle(edge.ref, edge.cur)) AddEdge(edge, width);
  }
  for (size_t i = 0; i < x_.size(); ++i) {
    double* const x = x_[i].data();
    if (graph.poses[i].is_fixed && problem_->HasParameterBlock(x)) {
      problem_->SetParameterBlockConstant(x);
    }
  }
}

void GraphProblem::AddEdge(const GraphTerms::Edge& edge, double width) {
  ceres::LossFunction* loss = nullptr;
  if (edge.loss != nullptr) loss = &losses_.emplace_back(edge.loss, width);
  problem_->AddResidualBlock(
      new EdgeBlock(RelativePoseErrorTerm::Of(edge.cur_from_ref, edge.root),
                    &origins_[edge.ref], &origins_[edge.cur]),
      loss, x_[edge.ref].data(), x_[edge.cur].data());
}

double GraphProblem::Cost() {
  double cost = 0.0;
  problem_->Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return cost;
}

void GraphProblem::Solve(const ceres::Solver::Options& options,
                         ceres::Solver::Summary* summary) {
  ceres::Solve(options, problem_.get(), summary);
}

Rigid3d GraphProblem::WorldFromCam(int pose) const {
  return origins_[pose].CurFromPrev(x_[pose].data()).Inverse();
}

ceres::CRSMatrix GraphProblem::Jacobian(const std::vector<int>& poses) {
  ceres::Problem::EvaluateOptions evaluate;
  for (const int pose : poses) {
    evaluate.parameter_blocks.push_back(x_[pose].data());
  }
  ceres::CRSMatrix jacobian;
  problem_->Evaluate(evaluate, nullptr, nullptr, nullptr, &jacobian);
  return jacobian;
}

// A pose that is fixed and that nothing is known of is no parameter at all.
bool GraphProblem::IsConstant(int pose) const {
  const double* x = x_[pose].data();
  return !problem_->HasParameterBlock(x) ||
         problem_->IsParameterBlockConstant(x);
}

std::vector<MotionMatrix> GraphProblem::MarginalCovariances(
    const std::vector<int>& poses, int threads) {
  ceres::Covariance::Options options;
  options.num_threads = threads;
  ceres::Covariance covariance(options);
  std::vector<std::pair<const double*, const double*>> wanted;
  for (const int pose : poses) {
    const double* x = x_[pose].data();
    if (!IsConstant(pose)) wanted.emplace_back(x, x);
  }
  if (!wanted.empty() && !covariance.Compute(wanted, problem_.get())) {
    return {};
  }
  std::vector<MotionMatrix> result;
  for (const int pose : poses) {
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> block;
    block.setZero();
    const double* x = x_[pose].data();
    if (!IsConstant(pose)) covariance.GetCovarianceBlock(x, x, block.data());
    result.push_back(block);
  }
  return result;
}

}  // namespace rgbd_pose
