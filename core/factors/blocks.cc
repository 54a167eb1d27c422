#include "core/factors/blocks.h"

namespace rgbd_pose {

Eigen::Matrix<double, 7, 6> PoseBlock::PlusJacobian(const double* x) {
  Eigen::Matrix<double, 7, 6> J = Eigen::Matrix<double, 7, 6>::Zero();
  J.topLeftCorner<4, 3>() = 0.5 * HalfAngleJacobian(x);
  J.bottomRightCorner<3, 3>().setIdentity();
  return J;
}

void PoseBlock::Plus(const double* x, const double* d, double* moved) {
  const PoseOf<double> pose = Read(x);
  const Eigen::Quaterniond turn =
      Rigid3d::FromRotationVector({d[0], d[1], d[2]}, {0, 0, 0}).rotation;
  Eigen::Map<Eigen::Vector4d>(moved, 4) = (pose.q * turn).coeffs();
  for (int i = 0; i < 3; ++i) moved[4 + i] = x[4 + i] + d[3 + i];
}

Eigen::Matrix<double, 6, 1> PoseBlock::Minus(const double* y, const double* x) {
  const PoseOf<double> to = Read(y), from = Read(x);
  Eigen::Matrix<double, 6, 1> d;
  d << RotationVector(from.q.conjugate() * to.q), to.p - from.p;
  return d;
}

std::string PoseBlock::NameOf(int tangent) {
  return (tangent < 3 ? "rotation about " : "position along ") +
         std::string(1, "xyz"[tangent % 3]);
}

PoseVector PoseBlock::Random(FactorSampler* random) {
  return PoseVectorOf(random->Motion());
}

Eigen::Matrix<double, 4, 3> PoseBlock::HalfAngleJacobian(const double* q) {
  Eigen::Matrix<double, 4, 3> J;
  J << q[3], -q[2], q[1],  //
      q[2], q[3], -q[0],   //
      -q[1], q[0], q[3],   //
      -q[0], -q[1], -q[2];
  return J;
}

PoseVector PoseVectorOf(const Rigid3d& world_from_body) {
  PoseVector x;
  x << world_from_body.rotation.coeffs(), world_from_body.translation;
  return x;
}

PoseOf<double> PoseFrom(const Rigid3d& world_from_body) {
  return {world_from_body.rotation, world_from_body.translation};
}

Rigid3d RigidOf(const PoseVector& pose) {
  return Rigid3d(Eigen::Quaterniond(pose[3], pose[0], pose[1], pose[2]),
                 pose.tail<3>());
}

std::string TwistBlock::NameOf(int k) {
  return (k < 3 ? "angular velocity about " : "velocity along ") +
         std::string(1, "xyz"[k % 3]);
}

}  // namespace rgbd_pose
