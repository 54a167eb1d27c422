#include "core/pose_graph/graph_problem.h"

#include <ceres/crs_matrix.h>

#include <cmath>
#include <utility>

#include "core/pose_graph/spanning_tree.h"

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

RotationAndCenter<double> MotionBetween(const RotationAndCenter<double>& ref,
                                        const RotationAndCenter<double>& cur,
                                        PosePairJacobian* jacobian) {
  const RotationAndCenter<double> motion = {cur.R * ref.R.transpose(),
                                            ref.R * (cur.C - ref.C)};
  jacobian->setZero();
  jacobian->block<3, 3>(0, 0) = -motion.R;
  jacobian->block<3, 3>(0, 6).setIdentity();
  jacobian->block<3, 3>(3, 0) = -CrossMatrix(motion.C);
  jacobian->block<3, 3>(3, 3) = -ref.R;
  jacobian->block<3, 3>(3, 9) = ref.R;
  return motion;
}

bool EdgeBlock::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  PosePairJacobian jacobian;
  const RotationAndCenter<double> motion = MotionBetween(
      ref_->PoseAt(parameters[0]), cur_->PoseAt(parameters[1]), &jacobian);
  for (int pose = 0; pose < 2; ++pose) {
    jacobian.middleCols<3>(6 * pose) *= EulerRates(parameters[pose]);
  }
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
    : x_(graph.poses.size(), MotionVector::Zero()),
      columns_(graph.poses.size(), -1) {
  origins_.reserve(graph.poses.size());
  for (const GraphTerms::Pose& pose : graph.poses) {
    origins_.emplace_back(pose.world_from_cam.Inverse());
  }
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  // PoseGraph::Solve checks the input.
  options.disable_all_safety_checks = true;
  problem_ = std::make_unique<ceres::Problem>(options);
  int columns = 0;
  for (size_t i = 0; i < x_.size(); ++i) {
    problem_->AddParameterBlock(x_[i].data(), 6);
    if (graph.poses[i].is_fixed) {
      problem_->SetParameterBlockConstant(x_[i].data());
    } else {
      columns_[i] = columns;
      columns += 6;
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

Eigen::SparseMatrix<double> GraphProblem::Information() {
  ceres::Problem::EvaluateOptions evaluate;
  for (size_t i = 0; i < x_.size(); ++i) {
    if (columns_[i] >= 0) evaluate.parameter_blocks.push_back(x_[i].data());
  }
  ceres::CRSMatrix crs;
  problem_->Evaluate(evaluate, nullptr, nullptr, nullptr, &crs);
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
  const Eigen::Map<const Sparse> J(
      crs.num_rows, crs.num_cols, static_cast<int>(crs.values.size()),
      crs.rows.data(), crs.cols.data(), crs.values.data());
  return J.transpose() * J;
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
  const auto poses_of = [&](const GraphTerms::Edge& edge) {
    return std::pair(origins_[edge.ref].PoseAt(x_[edge.ref].data()),
                     origins_[edge.cur].PoseAt(x_[edge.cur].data()));
  };
  // First what an edge says by itself: that is at least as uncertain, and most
  // graphs need no more.
  std::vector<bool> is_determined;
  PosePairJacobian jacobian;
  for (const GraphTerms::Edge& edge : graph.edges) {
    const auto [ref, cur] = poses_of(edge);
    const RotationAndCenter<double> motion = MotionBetween(ref, cur, &jacobian);
    jacobian.leftCols<6>().setIdentity();
    const MotionVector r = RelativePoseErrorTerm(edge.cur_from_ref, edge.root)
                               .ResidualAt(motion, &jacobian);
    double rho[3] = {0.0, 1.0, 0.0};
    if (edge.loss != nullptr) edge.loss->Evaluate(r.squaredNorm(), rho);
    const MotionMatrix information =
        rho[1] * jacobian.leftCols<6>().transpose() * jacobian.leftCols<6>();
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
    const GraphTerms::Edge& edge = graph.edges[i];
    const auto [ref, cur] = poses_of(edge);
    MotionBetween(ref, cur, &jacobian);
    Eigen::Matrix<double, 12, 12> covariance;
    covariance << CovarianceOf(inverse, edge.ref, edge.ref),
        CovarianceOf(inverse, edge.ref, edge.cur),
        CovarianceOf(inverse, edge.cur, edge.ref),
        CovarianceOf(inverse, edge.cur, edge.cur);
    is_determined[i] = EigenOf(jacobian * covariance * jacobian.transpose())
                           .eigenvalues()[5] <= limit;
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
    result.push_back(CovarianceOf(inverse, pose, pose));
  }
  return result;
}

}  // namespace rgbd_pose
