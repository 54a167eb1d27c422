#include "core/pose_graph/graph_problem.h"

#include <ceres/covariance.h>
#include <ceres/crs_matrix.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <set>
#include <utility>

namespace rgbd_pose {
namespace {

// The rotation about the axes of the camera (rad) caused by small changes of
// the angles (rad) at x: the columns of d omega / d[alpha beta gamma].
Eigen::Matrix3d EulerRates(const double* x) {
  const double sb = std::sin(x[1]), cb = std::cos(x[1]);
  const double sg = std::sin(x[2]), cg = std::cos(x[2]);
  Eigen::Matrix3d axes;
  axes << cb * cg, -sg, 0, cb * sg, cg, 0, -sb, 0, 1;
  return axes;
}

}  // namespace

MotionMatrix SqrtInformation(const MotionMatrix& information) {
  MotionMatrix none = MotionMatrix::Constant(NAN);
  if (!information.allFinite()) return none;
  // Scaled first: rotation and translation differ by orders of magnitude.
  const MotionVector size =
      information.diagonal().cwiseMax(0.0).cwiseSqrt().unaryExpr(
          [](double value) { return value > 0.0 ? value : 1.0; });
  const auto eigen = EigenOf(size.cwiseInverse().asDiagonal() * information *
                             size.cwiseInverse().asDiagonal());
  // Rounding changes zero eigenvalues by about 1e-16.
  if (eigen.eigenvalues().minCoeff() < -1e-9) return none;
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose() * size.asDiagonal();
}

MotionVector RelativePoseErrorTerm::ResidualAt(
    const RotationAndCenter<double>& motion, PosePairJacobian* jacobian) const {
  Eigen::Quaterniond q(motion.R * measured.R.transpose());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  MotionVector e;
  e << 2.0 * q.vec(), motion.C - measured.C;
  if (jacobian != nullptr) {
    // Exp(omega) q changes 2 vec q by w omega + omega x vec q.
    const Eigen::Matrix3d by_omega =
        q.w() * Eigen::Matrix3d::Identity() - CrossMatrix(q.vec());
    PosePairJacobian de = *jacobian;
    de.topRows<3>() = by_omega * jacobian->topRows<3>();
    jacobian->noalias() = root * de;
  }
  return root * e;
}

bool EdgeBlock::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const RotationAndCenter<double> ref = ref_->PoseAt(parameters[0]);
  const RotationAndCenter<double> cur = cur_->PoseAt(parameters[1]);
  const RotationAndCenter<double> motion = {cur.R * ref.R.transpose(),
                                            ref.R * (cur.C - ref.C)};
  const Eigen::Matrix3d axes = EulerRates(parameters[0]);
  PosePairJacobian jacobian = PosePairJacobian::Zero();
  jacobian.block<3, 3>(0, 0) = -motion.R * axes;
  jacobian.block<3, 3>(0, 6) = EulerRates(parameters[1]);
  jacobian.block<3, 3>(3, 0) = -CrossMatrix(motion.C) * axes;
  jacobian.block<3, 3>(3, 3) = -ref.R;
  jacobian.block<3, 3>(3, 9) = ref.R;
  Eigen::Map<MotionVector>(residuals, 6) =
      term_.ResidualAt(motion, jacobians != nullptr ? &jacobian : nullptr);
  for (int pose = 0; jacobians != nullptr && pose < 2; ++pose) {
    if (jacobians[pose] == nullptr) continue;
    Eigen::Map<RowMajorBlock>(jacobians[pose], 6, 6) =
        jacobian.middleCols<6>(6 * pose);
  }
  return true;
}

GraphProblem::GraphProblem(const GraphTerms& graph, double width)
    : x_(graph.poses.size(), MotionVector::Zero()) {
  origins_.reserve(graph.poses.size());
  for (const GraphTerms::Pose& pose : graph.poses) {
    origins_.emplace_back(pose.world_from_cam.Inverse());
  }
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  // PoseGraph::Solve checks the input.
  options.disable_all_safety_checks = true;
  problem_ = std::make_unique<ceres::Problem>(options);
  for (size_t i = 0; i < x_.size(); ++i) {
    problem_->AddParameterBlock(x_[i].data(), 6);
    if (graph.poses[i].is_fixed) {
      problem_->SetParameterBlockConstant(x_[i].data());
    }
  }
  for (const GraphTerms::Edge& edge : graph.edges) {
    if (graph.IsIdle(edge.ref, edge.cur)) continue;
    ceres::LossFunction* loss = nullptr;
    if (edge.loss != nullptr) loss = &losses_.emplace_back(edge.loss, width);
    problem_->AddResidualBlock(
        new EdgeBlock({edge.cur_from_ref, edge.root}, &origins_[edge.ref],
                      &origins_[edge.cur]),
        loss, x_[edge.ref].data(), x_[edge.cur].data());
  }
}

int GraphProblem::FindUndetermined(double max_standard_deviation) {
  if (is_empty()) return -1;
  std::vector<int> free;  // the pose of each six columns
  ceres::Problem::EvaluateOptions evaluate;
  for (size_t i = 0; i < x_.size(); ++i) {
    if (IsConstant(static_cast<int>(i))) continue;
    free.push_back(static_cast<int>(i));
    evaluate.parameter_blocks.push_back(x_[i].data());
  }
  ceres::CRSMatrix crs;  // the Jacobian of all residuals under their losses
  problem_->Evaluate(evaluate, nullptr, nullptr, nullptr, &crs);
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
    return free[ldlt.permutationPinv().indices()[k] / 6];
  }
  return -1;
}

std::vector<MotionMatrix> GraphProblem::MarginalCovariances(
    const std::vector<int>& poses, int threads) {
  ceres::Covariance::Options options;
  options.num_threads = threads;
  ceres::Covariance covariance(options);
  std::vector<std::pair<const double*, const double*>> wanted;
  for (const int pose : std::set<int>(poses.begin(), poses.end())) {
    const double* x = x_[pose].data();
    if (!IsConstant(pose)) wanted.emplace_back(x, x);
  }
  if (!wanted.empty() && !covariance.Compute(wanted, problem_.get())) return {};
  std::vector<MotionMatrix> result;
  for (const int pose : poses) {
    RowMajorBlock block = RowMajorBlock::Zero();
    const double* x = x_[pose].data();
    if (!IsConstant(pose)) covariance.GetCovarianceBlock(x, x, block.data());
    result.push_back(block);
  }
  return result;
}

}  // namespace rgbd_pose
