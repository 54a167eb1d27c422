#include "core/geometry/motion.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace rgbd_pose {
namespace {

// dR/d(alpha, beta, gamma) of Rz(gamma) Ry(beta) Rx(alpha): Table 2.1.
std::array<Eigen::Matrix3d, 3> RotationDerivatives(const double* angles) {
  const double sa = std::sin(angles[0]), ca = std::cos(angles[0]);
  const double sb = std::sin(angles[1]), cb = std::cos(angles[1]);
  const double sg = std::sin(angles[2]), cg = std::cos(angles[2]);
  std::array<Eigen::Matrix3d, 3> dR;
  dR[0] << 0, ca * sb * cg + sa * sg, -sa * sb * cg + ca * sg,  //
      0, ca * sb * sg - sa * cg, -sa * sb * sg - ca * cg,       //
      0, ca * cb, -sa * cb;
  dR[1] << -sb * cg, sa * cb * cg, ca * cb * cg,  //
      -sb * sg, sa * cb * sg, ca * cb * sg,       //
      -cb, -sa * sb, -ca * sb;
  dR[2] << -cb * sg, -sa * sb * sg - ca * cg, -ca * sb * sg + sa * cg,  //
      cb * cg, sa * sb * cg - ca * sg, ca * sb * cg + sa * sg,          //
      0, 0, 0;
  return dR;
}

}  // namespace

LinearizationPoint::LinearizationPoint(const Rigid3d& cur_from_prev)
    : R_(cur_from_prev.rotation.toRotationMatrix()),
      C_(-(R_.transpose() * cur_from_prev.translation)) {
  shared_x_.setConstant(NAN);
}

MotionDerivatives LinearizationPoint::DerivativesAt(const double* x) const {
  MotionDerivatives motion;
  static_cast<RotationAndCenter<double>&>(motion) = PoseAt(x);
  motion.dR = RotationDerivatives(x);
  for (Eigen::Matrix3d& dR : motion.dR) dR = (dR * R_).eval();
  return motion;
}

MotionDerivatives DerivativesAt(const Rigid3d& cur_from_prev) {
  const MotionVector zero = MotionVector::Zero();
  return LinearizationPoint(cur_from_prev).DerivativesAt(zero.data());
}

Rigid3d LinearizationPoint::CurFromPrev(const double* x) const {
  const RotationAndCenter<double> pose = PoseAt(x);
  return Rigid3d(Eigen::Quaterniond(pose.R), -(pose.R * pose.C));
}

MotionMatrix ComposedCovariance(const Rigid3d& c_from_b,
                                const MotionMatrix& covariance_cb,
                                const Rigid3d& b_from_a,
                                const MotionMatrix& covariance_ba) {
  const Eigen::Matrix3d R_cb = c_from_b.rotation.toRotationMatrix();
  const Eigen::Matrix3d R_ab = b_from_a.rotation.toRotationMatrix().transpose();
  const Eigen::Vector3d C = -(R_cb.transpose() * c_from_b.translation);
  MotionMatrix by_cb = MotionMatrix::Identity();
  by_cb.bottomRightCorner<3, 3>() = R_ab;
  MotionMatrix by_ba = MotionMatrix::Identity();
  by_ba.topLeftCorner<3, 3>() = R_cb;
  by_ba.bottomLeftCorner<3, 3>() = R_ab * CrossMatrix(C);
  return by_cb * covariance_cb * by_cb.transpose() +
         by_ba * covariance_ba * by_ba.transpose();
}

double SquaredMahalanobisDistance(const Rigid3d& cur_from_prev,
                                  const Rigid3d& other,
                                  const MotionMatrix& covariance) {
  MotionVector error;
  error << RotationVector(cur_from_prev.rotation * other.rotation.conjugate()),
      cur_from_prev.Inverse().translation - other.Inverse().translation;
  return error.dot(covariance.ldlt().solve(error));
}

MotionVector MotionFromRigid(const Rigid3d& cur_from_prev) {
  const Eigen::Matrix3d R = cur_from_prev.rotation.toRotationMatrix();
  MotionVector x;
  const double cos_beta = std::hypot(R(0, 0), R(1, 0));
  x[1] = std::atan2(-R(2, 0), cos_beta);
  // If cos(beta) vanishes, only alpha -+ gamma is determined: use gamma = 0.
  constexpr double kGimbalLock = 1e-12;
  if (cos_beta > kGimbalLock) {
    x[0] = std::atan2(R(2, 1), R(2, 2));
    x[2] = std::atan2(R(1, 0), R(0, 0));
  } else {
    x[0] = std::atan2(-R(1, 2), R(1, 1));
    x[2] = 0.0;
  }
  x.tail<3>() = -(R.transpose() * cur_from_prev.translation);
  return x;
}

}  // namespace rgbd_pose
