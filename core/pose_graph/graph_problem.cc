#include "core/pose_graph/graph_problem.h"

#include <ceres/covariance.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <limits>
#include <utility>

namespace rgbd_pose {
namespace {

// Copies the halves of a Jacobian that Ceres requests.
template <typename Jacobian>
void Split(const Jacobian& both, double** jacobians) {
  if (jacobians == nullptr) return;
  for (int pose = 0; pose < 2; ++pose) {
    if (jacobians[pose] == nullptr) continue;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>(
        jacobians[pose], both.rows(), 6) =
        both.template middleCols<6>(6 * pose);
  }
}

}  // namespace

MotionMatrix SqrtInformation(const MotionMatrix& information) {
  MotionMatrix none =
      MotionMatrix::Constant(std::numeric_limits<double>::quiet_NaN());
  if (!information.allFinite()) return none;
  // Scaled first: rotation and translation differ by orders of magnitude.
  const MotionVector size =
      information.diagonal().cwiseMax(0.0).cwiseSqrt().unaryExpr(
          [](double value) { return value > 0.0 ? value : 1.0; });
  const Eigen::SelfAdjointEigenSolver<MotionMatrix> eigen(
      size.cwiseInverse().asDiagonal() * information *
      size.cwiseInverse().asDiagonal());
  // Rounding changes zero eigenvalues by about 1e-16.
  if (eigen.eigenvalues().minCoeff() < -1e-9) return none;
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose() * size.asDiagonal();
}

MotionVector RelativePoseErrorTerm::ResidualAt(
    const RelativeMotion& pair, PosePairJacobian* jacobian) const {
  Eigen::Quaterniond q(pair.motion.R * measured.R.transpose());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  MotionVector e;
  e << 2.0 * q.vec(), pair.motion.C - measured.C;
  if (jacobian != nullptr) {
    // Exp(omega) q changes 2 vec q by w omega + omega x vec q.
    const Eigen::Matrix3d by_omega =
        q.w() * Eigen::Matrix3d::Identity() - CrossMatrix(q.vec());
    PosePairJacobian de = pair.jacobian;
    de.topRows<3>() = by_omega * pair.jacobian.topRows<3>();
    jacobian->noalias() = root * de;
  }
  return root * e;
}

bool EdgeBlock::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const RelativeMotion pair =
      RelativeMotionAt(*ref_, parameters[0], *cur_, parameters[1]);
  PosePairJacobian jacobian;
  Eigen::Map<MotionVector>(residuals, 6) =
      term_.ResidualAt(pair, jacobians != nullptr ? &jacobian : nullptr);
  Split(jacobian, jacobians);
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
  options.disable_all_safety_checks =
      true;  // PoseGraph::Solve checks the input
  problem_ = std::make_unique<ceres::Problem>(options);
  for (size_t i = 0; i < x_.size(); ++i) {
    if (!graph.poses[i].is_fixed) problem_->AddParameterBlock(x_[i].data(), 6);
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
  for (size_t i = 0; i < x_.size(); ++i) {
    double* const x = x_[i].data();
    if (graph.poses[i].is_fixed && problem_->HasParameterBlock(x)) {
      problem_->SetParameterBlockConstant(x);
    }
  }
}

// A fixed pose without edges to free poses is not a parameter of the problem.
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

// The pivots of a Cholesky decomposition are the information on one parameter
// if those eliminated before it are unknown and those after it known: an upper
// bound of the actual information, exact for the last pivot.
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

}  // namespace rgbd_pose
