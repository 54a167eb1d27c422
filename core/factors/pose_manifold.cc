#include "core/factors/pose_manifold.h"

#include <algorithm>

#include "core/util/input_error.h"

namespace rgbd_pose {

PoseManifold::PoseManifold(const std::vector<int>& constant) {
  for (const int k : constant) {
    if (k >= 0 && k < PoseBlock::kTangent) continue;
    throw InputError("a pose has the directions 0 to 5, not " +
                     std::to_string(k));
  }
  for (int k = 0; k < PoseBlock::kTangent; ++k) {
    if (std::count(constant.begin(), constant.end(), k) == 0) {
      free_.push_back(k);
    }
  }
}

bool PoseManifold::Plus(const double* x, const double* d, double* moved) const {
  MotionVector step = MotionVector::Zero();
  for (size_t k = 0; k < free_.size(); ++k) step[free_[k]] = d[k];
  PoseBlock::Plus(x, step.data(), moved);
  return true;
}

bool PoseManifold::Jacobian(const double* x, double* jacobian) const {
  const Eigen::Matrix<double, 7, 6> J = PoseBlock::PlusJacobian(x);
  for (int row = 0; row < PoseBlock::kSize; ++row) {
    for (const int k : free_) *jacobian++ = J(row, k);
  }
  return true;
}

#ifndef RGBD_POSE_LOCAL_PARAMETERIZATION
bool PoseManifold::Minus(const double* y, const double* x, double* d) const {
  const MotionVector step = PoseBlock::Minus(y, x);
  for (size_t k = 0; k < free_.size(); ++k) d[k] = step[free_[k]];
  return true;
}

bool PoseManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Matrix<double, 6, 7, Eigen::RowMajor> J;
  PoseBlock::Lift<6>(MotionMatrix::Identity(), x, J.data());
  for (const int k : free_) {
    std::copy_n(J.row(k).data(), PoseBlock::kSize, jacobian);
    jacobian += PoseBlock::kSize;
  }
  return true;
}
#endif

MotionMatrix PoseCovariance(const MotionMatrix& covariance_in_tangent) {
  // A turn of the body by Exp(omega) is one of cam_from_world by Exp(-omega).
  MotionMatrix covariance = covariance_in_tangent;
  covariance.topRightCorner<3, 3>() *= -1.0;
  covariance.bottomLeftCorner<3, 3>() *= -1.0;
  return covariance;
}

}  // namespace rgbd_pose
