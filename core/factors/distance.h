#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/factors/blocks.h"
#include "core/factors/sampler.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A known distance between two points, each fixed to one of two bodies: of
// both bodies themselves (radio ranging), or of two marks that they see
//
//   r = (|p_a + R_a l_a - p_b - R_b l_b| - metres) / sigma
//
// Where the points coincide there is no direction in which to move: there the
// Jacobian is zero.
struct DistanceFactor {
  static constexpr char kName[] = "distance";
  using Blocks = BlockList<PoseBlock, PoseBlock>;
  static constexpr int kRows = 1;
  using ByPose = TangentJacobian<kRows, PoseBlock>;

  double metres = 1.0;  // as measured
  double sigma = 0.01;  // m

  // l_a and l_b, the points in the axes of the bodies, m.
  Eigen::Vector3d in_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d in_b = Eigen::Vector3d::Zero();

  template <typename T>
  bool Residual(const PoseOf<T>& a, const PoseOf<T>& b, T* r) const {
    using std::sqrt;
    const Eigen::Matrix<T, 3, 1> apart = a.p + a.q * in_a.template cast<T>() -
                                         b.p - b.q * in_b.template cast<T>();
    const T squared = apart.squaredNorm();
    // The root has no derivative at 0. NaN stays, so that a solver notices it.
    const T length = squared == T(0.0) ? T(0.0) : sqrt(squared);
    r[0] = (length - T(metres)) / T(sigma);
    return true;
  }

  bool Jacobian(const PoseOf<double>& a, const PoseOf<double>& b, double* r,
                ByPose* by_a, ByPose* by_b) const {
    const Eigen::Matrix3d R_a = a.R(), R_b = b.R();
    const Eigen::Vector3d apart = a.p + R_a * in_a - b.p - R_b * in_b;
    const double length = apart.norm();
    r[0] = (length - metres) / sigma;
    const double scale = length > 0.0 ? 1.0 / (length * sigma) : 0.0;
    const Eigen::RowVector3d along = scale * apart.transpose();
    by_a->leftCols<3>() = -along * R_a * CrossMatrix(in_a);
    by_b->leftCols<3>() = along * R_b * CrossMatrix(in_b);
    by_a->rightCols<3>() = along;
    by_b->rightCols<3>() = -along;
    return true;
  }

  static DistanceFactor Sample(FactorSampler* random) {
    return {random->Uniform(0.1, 3.0), random->Uniform(0.01, 0.1),
            random->Vector<3>(1.0), random->Vector<3>(1.0)};
  }
};

}  // namespace rgbd_pose
