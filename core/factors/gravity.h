#pragma once

#include <Eigen/Core>

#include "core/factors/blocks.h"
#include "core/factors/sampler.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Which way is up in a body's axes, as an accelerometer (less its bias)
// measures it while the body does not accelerate,
//
//   r = (R^T up - up_m) / sigma.
//
// Its length is 2 sin(angle / 2) / sigma: there is no second minimum at half a
// turn. Of its 3 rows 2 count: to first order the one along up_m is 0.
struct GravityFactor {
  static constexpr char kName[] = "gravity";  // for messages
  // Its blocks in their order: the body.
  using Blocks = BlockList<PoseBlock>;
  static constexpr int kRows = 3;  // of the residual

  Eigen::Vector3d up_in_body;  // measured, of length 1
  Eigen::Vector3d up;          // in the world, of length 1
  double sigma;                // of the direction, rad

  // Writes r[3].
  template <typename T>
  bool Residual(const PoseOf<T>& body, T* r) const {
    Eigen::Map<Eigen::Matrix<T, 3, 1>> whitened(r);
    whitened = (body.q.conjugate() * Eigen::Matrix<T, 3, 1>(up.cast<T>()) -
                up_in_body.cast<T>()) /
               T(sigma);
    return true;
  }

  // The same, and its derivatives in the tangents of the blocks.
  bool Jacobian(const PoseOf<double>& body, double* r,
                TangentJacobian<kRows, PoseBlock>* by_body) const {
    const Eigen::Vector3d turned = body.q.conjugate() * up;
    Eigen::Map<Eigen::Vector3d>(r, 3) = (turned - up_in_body) / sigma;
    by_body->setZero();
    by_body->leftCols<3>() = CrossMatrix(turned) / sigma;
    return true;
  }

  // A random one, for checks.
  static GravityFactor Sample(FactorSampler* random) {
    return {random->Vector<3>(1.0).normalized(),
            random->Vector<3>(1.0).normalized(), random->Uniform(0.1, 1.0)};
  }
};

}  // namespace rgbd_pose
