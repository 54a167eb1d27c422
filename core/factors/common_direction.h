#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/factors/blocks.h"
#include "core/factors/sampler.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A direction that is known in the axes of two bodies a and b, wherever it
// points in the world,
//
//   r = (R_a^T R_b m_b - m_a) / sigma
//
// If b is an upright frame, whose z axis is up, and m_b = z, this is gravity
// in a world of which nobody knows yet how it lies: b is estimated, too
// (GravityFactor: it is known). These are three rows of rank 2, of length
// 2 sin(angle / 2) / sigma.
struct CommonDirectionFactor {
  static constexpr char kName[] = "common_direction";
  using Blocks = BlockList<PoseBlock, PoseBlock>;
  static constexpr int kRows = 3;
  using ByPose = TangentJacobian<kRows, PoseBlock>;

  Eigen::Vector3d in_a;  // m_a, of length 1, as measured
  Eigen::Vector3d in_b;  // m_b, of length 1
  double sigma = 0.01;   // of the angle between the two, rad

  template <typename T>
  bool Residual(const PoseOf<T>& a, const PoseOf<T>& b, T* r) const {
    Eigen::Map<Eigen::Matrix<T, 3, 1>> whitened(r);
    whitened = (a.q.conjugate() * (b.q * in_b.template cast<T>()) -
                in_a.template cast<T>()) /
               T(sigma);
    return true;
  }

  bool Jacobian(const PoseOf<double>& a, const PoseOf<double>& b, double* r,
                ByPose* by_a, ByPose* by_b) const;

  static CommonDirectionFactor Sample(FactorSampler* random);
};

}  // namespace rgbd_pose
