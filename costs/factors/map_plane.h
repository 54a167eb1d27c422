#pragma once

#include <Eigen/Core>

#include "core/factors/blocks.h"
#include "core/factors/sampler.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A point that the body measures lies on a plane of the map, n . X = d (Chen &
// Medioni, IVC 1992),
//
//   r = (n . (R x + p) - d) / sigma
struct MapPlaneFactor {
  static constexpr char kName[] = "map_plane";
  using Blocks = BlockList<PoseBlock>;
  static constexpr int kRows = 1;

  Eigen::Vector3d in_body;  // x, m
  Eigen::Vector3d normal;   // n, in the axes of the world, of length 1
  double distance = 0.0;    // d, of the plane from the origin, m
  double sigma = 0.01;      // of the point along the normal, m

  template <typename T>
  bool Residual(const PoseOf<T>& pose, T* r) const {
    const Eigen::Matrix<T, 3, 1> in_world =
        pose.q * in_body.template cast<T>() + pose.p;
    r[0] = (normal.template cast<T>().dot(in_world) - T(distance)) / T(sigma);
    return true;
  }

  bool Jacobian(const PoseOf<double>& pose, double* r,
                TangentJacobian<kRows, PoseBlock>* by_pose) const {
    Residual(pose, r);
    const Eigen::Vector3d in_axes = pose.q.conjugate() * normal;
    by_pose->leftCols<3>() = in_body.cross(in_axes).transpose() / sigma;
    by_pose->rightCols<3>() = normal.transpose() / sigma;
    return true;
  }

  static MapPlaneFactor Sample(FactorSampler* random) {
    return {random->Vector<3>(3.0),
            random->Motion().rotation * Eigen::Vector3d::UnitZ(),
            random->Uniform(-2.0, 2.0), random->Uniform(0.01, 0.1)};
  }
};

}  // namespace rgbd_pose
