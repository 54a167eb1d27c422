#include "core/pose_graph/graph_problem.h"

#include <ceres/covariance.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace rgbd_pose {
namespace {

std::string NameOf(int pose) { return "pose " + std::to_string(pose); }

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

RelativePoseErrorTerm RelativePoseErrorTerm::Of(const Rigid3d& cur_from_ref,
                                                const MotionMatrix& root) {
  RelativePoseErrorTerm term;
  term.measured.R = cur_from_ref.rotation.toRotationMatrix();
  term.measured.C = cur_from_ref.Inverse().translation;
  term.root = root;
  return term;
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

std::string FindBadInput(const GraphTerms& graph) {
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    if (graph.poses[i].world_from_cam.IsFinite()) continue;
    return NameOf(static_cast<int>(i)) + " is not finite";
  }
  for (const GraphTerms::Edge& edge : graph.edges) {
    const std::string name =
        "the edge from " + NameOf(edge.ref) + " to " + NameOf(edge.cur);
    if (!graph.Has(edge.ref) || !graph.Has(edge.cur) || edge.ref == edge.cur) {
      return name + " does not connect two poses of the graph";
    }
    if (!edge.cur_from_ref.IsFinite()) {
      return name + " has a motion that is not finite";
    }
    if (!edge.root.allFinite())
      return name + " has a covariance that is not positive definite";
  }
  return "";
}

// Groups connected poses by the smallest number among them (union-find). All
// fixed poses count as connected.
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
    return NameOf(i) + " is not connected to any fixed pose";
  }
  return "";
}

// The pivots of a Cholesky decomposition are the information on one parameter
// if those eliminated before it are unknown and those after it known: an upper
// bound of the actual information, exact for the last pivot.
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
