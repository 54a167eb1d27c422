#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

// The alignment (bytes) of Eigen's memory that the libraries were built with, a
// usage requirement of rgbd_pose::core. Eigen chooses it by the compiler flags
// for the instruction set; a program that mixes two alignments crashes.
#ifdef RGBD_POSE_EIGEN_ALIGN
static_assert(EIGEN_MAX_ALIGN_BYTES == RGBD_POSE_EIGEN_ALIGN &&
                  EIGEN_MAX_STATIC_ALIGN_BYTES == RGBD_POSE_EIGEN_ALIGN,
              "rgbd_pose was built with another alignment of Eigen's vectors "
              "(RGBD_POSE_EIGEN_ALIGN): leave out -march=native, -mavx and the "
              "like, or add -DEIGEN_MAX_ALIGN_BYTES=16 to all code that uses "
              "Eigen, or build rgbd_pose with the same flags");
#endif

namespace rgbd_pose {

// The shortest rotation vector of a rotation, rad.
Eigen::Vector3d RotationVector(const Eigen::Quaterniond& rotation);

// [v]x, with [v]x w = v x w.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v);

// A rigid motion, named target_from_source: point_in_target =
// target_from_source * point_in_source. Inner names cancel in products:
// a_from_c = a_from_b * b_from_c. Translation in metres.
struct Rigid3d {
  // Turns source axes into target axes; the source's origin in the target.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Rigid3d() = default;  // the identity

  // The rotation is normalised; translation in metres.
  Rigid3d(const Eigen::Quaterniond& target_from_source_rotation,
          const Eigen::Vector3d& source_origin_in_target);

  // The same from a rotation vector (rad).
  static Rigid3d FromRotationVector(
      const Eigen::Vector3d& rotation,
      const Eigen::Vector3d& source_origin_in_target);

  // Transforms a point from source to target. Inline for loops over points.
  Eigen::Vector3d operator*(const Eigen::Vector3d& point_in_source) const {
    return rotation * point_in_source + translation;
  }

  // Returns target_from_other.
  Rigid3d operator*(const Rigid3d& source_from_other) const;

  // Returns source_from_target.
  Rigid3d Inverse() const;

  // The angle in [0, pi], rad.
  double Angle() const;

  // Whether it moves nothing, exactly.
  bool IsIdentity() const;

  // Exact comparison.
  bool operator==(const Rigid3d& other) const;

  // Whether no component is NaN or infinite.
  bool IsFinite() const;
};

}  // namespace rgbd_pose
