#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Weighted sums over pairs of points, updated pair by pair without loss of
// precision far from the origin (West, Communications of the ACM 22, 1979).
struct PairMoments {
  int count = 0;
  double weight = 0.0;
  Eigen::Vector3d target_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d source_mean = Eigen::Vector3d::Zero();

  // Sums about the means: weight target source^T, and weight squared distances.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double spread = 0.0;

  // `pair_weight` must be positive.
  void Add(const Eigen::Vector3d& target, const Eigen::Vector3d& source,
           double pair_weight = 1.0);
};

// The rotation R (never a reflection) that maximises trace(R^T m). If m is not
// finite: the identity with stiffness 0.
struct NearestRotation {
  explicit NearestRotation(const Eigen::Matrix3d& m);

  Eigen::Matrix3d rotation;
  // How well R is determined: a small further rotation about the least
  // determined axis reduces the trace by stiffness / 2 * angle^2.
  double stiffness;
};

// The rigid motion target_from_source, without scale, that minimises the
// weighted sum of squared distances |target - target_from_source * source|^2
// (Horn 1987; Umeyama 1991). Weights are inverse variances of one component of
// that difference (1 / m^2). Empty if fewer than three pairs, or points so
// close to a spot or line that noise alone could determine the motion.
std::optional<Rigid3d> UmeyamaAlignment(const PairMoments& moments);

}  // namespace rgbd_pose
