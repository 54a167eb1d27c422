#include "core/pose_graph/graph_blocks.h"

#include <Eigen/Eigenvalues>
#include <limits>

namespace rgbd_pose {
namespace {

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

}  // namespace

MotionMatrix SqrtInformation(const MotionMatrix& information) {
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

}  // namespace rgbd_pose
