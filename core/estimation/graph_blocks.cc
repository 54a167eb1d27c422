#include "core/estimation/graph_blocks.h"

#include <ceres/autodiff_cost_function.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <limits>

namespace rgbd_pose {
namespace {

using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

// The two halves of a Jacobian, as far as Ceres asks for them.
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

struct EdgeFunctor {
  template <typename T>
  bool operator()(const T* x_ref, const T* x_cur, T* residuals) const {
    term.Residual(MotionBetween(ref->PoseAt(x_ref), cur->PoseAt(x_cur)),
                  residuals);
    return true;
  }

  EdgeTerm term;
  const MotionOrigin* ref;
  const MotionOrigin* cur;
};

// The parameters of a motion about an origin (R_0, C_0).
template <typename T>
Eigen::Matrix<T, 6, 1> ParametersOf(const MotionPose<T>& motion,
                                    const Eigen::Matrix3d& R_0,
                                    const Eigen::Vector3d& C_0) {
  using std::atan2;
  using std::sqrt;
  const Eigen::Matrix<T, 3, 3> E = motion.R * R_0.transpose();
  Eigen::Matrix<T, 6, 1> x;
  x[0] = atan2(E(2, 1), E(2, 2));
  x[1] = atan2(-E(2, 0), sqrt(E(0, 0) * E(0, 0) + E(1, 0) * E(1, 0)));
  x[2] = atan2(E(1, 0), E(0, 0));
  for (int i = 0; i < 3; ++i) x[3 + i] = motion.C[i] - C_0[i];
  return x;
}

}  // namespace

MotionMatrix SquareRootOf(const MotionMatrix& information) {
  MotionMatrix none =
      MotionMatrix::Constant(std::numeric_limits<double>::quiet_NaN());
  if (!information.allFinite()) return none;
  // Rotation and translation differ by orders of magnitude: to equal size.
  const MotionVector size =
      information.diagonal().cwiseMax(0.0).cwiseSqrt().unaryExpr(
          [](double value) { return value > 0.0 ? value : 1.0; });
  const Eigen::SelfAdjointEigenSolver<MotionMatrix> eigen(
      size.cwiseInverse().asDiagonal() * information *
      size.cwiseInverse().asDiagonal());
  // Rounding leaves what is zero at some 1e-16.
  if (eigen.eigenvalues().minCoeff() < -1e-9) return none;
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose() * size.asDiagonal();
}

EdgeTerm EdgeTerm::Of(const Rigid3d& cur_from_ref, const MotionMatrix& root) {
  EdgeTerm term;
  term.measured.R = cur_from_ref.rotation.toRotationMatrix();
  term.measured.C = cur_from_ref.Inverse().translation;
  term.root = root;
  return term;
}

MotionVector EdgeTerm::ResidualAt(const RelativeMotion& pair,
                                  PosePairJacobian* jacobian) const {
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

ceres::CostFunction* MakeEdgeOracle(const EdgeTerm& term,
                                    const MotionOrigin* ref,
                                    const MotionOrigin* cur) {
  return new ceres::AutoDiffCostFunction<EdgeFunctor, 6, 6, 6>(
      new EdgeFunctor{term, ref, cur});
}

LiveBlock::LiveBlock(const ceres::CostFunction* block,
                     const MotionOrigin* motion, const MotionOrigin* ref,
                     const MotionOrigin* cur, bool by_jet)
    : block_(block),
      motion_R_(motion->PoseAt(MotionVector::Zero().eval().data()).R),
      motion_C_(motion->PoseAt(MotionVector::Zero().eval().data()).C),
      ref_(ref),
      cur_(cur),
      by_jet_(by_jet) {
  set_num_residuals(block->num_residuals());
  mutable_parameter_block_sizes()->assign(2, 6);
}

bool LiveBlock::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  PosePairJacobian by_poses;  // d x / d[x_ref x_cur], x of the motion
  MotionVector x;
  if (by_jet_) {
    using Jet = ceres::Jet<double, 12>;
    std::array<Jet, 12> poses;
    for (int i = 0; i < 12; ++i) {
      poses[i] = Jet(parameters[i / 6][i % 6], i);
    }
    const auto jets =
        ParametersOf(MotionBetween(ref_->PoseAt(poses.data()),
                                   cur_->PoseAt(poses.data() + 6)),
                     motion_R_, motion_C_);
    for (int i = 0; i < 6; ++i) {
      x[i] = jets[i].a;
      by_poses.row(i) = jets[i].v;
    }
  } else {
    const RelativeMotion pair =
        RelativeMotionAt(*ref_, parameters[0], *cur_, parameters[1]);
    x = ParametersOf(pair.motion, motion_R_, motion_C_);
    by_poses = pair.jacobian;
    by_poses.topRows<3>() =
        AxesOfAngles(x.data()).inverse() * pair.jacobian.topRows<3>();
  }
  const double* at = x.data();
  if (jacobians == nullptr) return block_->Evaluate(&at, residuals, nullptr);
  // Of a block of a match; the compressed one has 7.
  constexpr int kMaxRows = 16;
  Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, kMaxRows, 6> by_x(
      num_residuals(), 6);
  double* rows = by_x.data();
  if (!block_->Evaluate(&at, residuals, &rows)) return false;
  const Eigen::Matrix<double, Eigen::Dynamic, 12, Eigen::RowMajor, kMaxRows, 12>
      both = by_x * by_poses;
  Split(both, jacobians);
  return true;
}

}  // namespace rgbd_pose
