#include "core/geometry/rigid3.h"

#include <cmath>

namespace rgbd_pose {

Eigen::Vector3d RotationVector(const Eigen::Quaterniond& rotation) {
  const double sine = rotation.vec().norm();
  if (sine == 0.0) return Eigen::Vector3d::Zero();
  const double angle = 2.0 * std::atan2(sine, std::abs(rotation.w()));
  return std::copysign(angle / sine, rotation.w()) * rotation.vec();
}

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Rigid3d::Rigid3d(const Eigen::Quaterniond& target_from_source_rotation,
                 const Eigen::Vector3d& source_origin_in_target)
    : rotation(target_from_source_rotation.normalized()),
      translation(source_origin_in_target) {}

Rigid3d Rigid3d::FromRotationVector(
    const Eigen::Vector3d& rotation,
    const Eigen::Vector3d& source_origin_in_target) {
  return Rigid3d(Eigen::Quaterniond(
                     Eigen::AngleAxisd(rotation.norm(), rotation.normalized())),
                 source_origin_in_target);
}

Rigid3d Rigid3d::operator*(const Rigid3d& source_from_other) const {
  return Rigid3d(rotation * source_from_other.rotation,
                 rotation * source_from_other.translation + translation);
}

Rigid3d Rigid3d::Inverse() const {
  const Eigen::Quaterniond inverse = rotation.conjugate();
  return Rigid3d(inverse, -(inverse * translation));
}

// Near 0 acos(w) would lose half of the digits.
double Rigid3d::Angle() const {
  return 2.0 * std::atan2(rotation.vec().norm(), std::abs(rotation.w()));
}

bool Rigid3d::IsIdentity() const {
  return Angle() == 0.0 && translation.isZero(0.0);
}

bool Rigid3d::operator==(const Rigid3d& other) const {
  return rotation.coeffs() == other.rotation.coeffs() &&
         translation == other.translation;
}

bool Rigid3d::IsFinite() const {
  return rotation.coeffs().allFinite() && translation.allFinite();
}

}  // namespace rgbd_pose
