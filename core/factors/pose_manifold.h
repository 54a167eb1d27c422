#pragma once

#include <ceres/problem.h>
#include <ceres/version.h>

#include <Eigen/Core>
#include <vector>

#include "core/factors/blocks.h"
#include "core/geometry/motion.h"

// Ceres 2.1 replaced local parameterisations by manifolds.
#if CERES_VERSION_MAJOR * 100 + CERES_VERSION_MINOR < 201
#define RGBD_POSE_LOCAL_PARAMETERIZATION
#endif
#ifdef RGBD_POSE_LOCAL_PARAMETERIZATION
#include <ceres/local_parameterization.h>
#else
#include <ceres/manifold.h>
#endif

namespace rgbd_pose {

// What Ceres calls the tangent of a block, in the version at hand.
#ifdef RGBD_POSE_LOCAL_PARAMETERIZATION
using CeresManifold = ceres::LocalParameterization;
#else
using CeresManifold = ceres::Manifold;
#endif

// The tangent of PoseBlock, [omega p], as Ceres needs it: the solver steps, and
// ceres::Covariance reports, in rad about the axes of the body and in metres
// along those of the world. Factors are as exact under any other manifold of
// unit quaternions.
class PoseManifold final : public CeresManifold {
 public:
  // Directions of [omega p], 0 to 5, in which the pose is not moved.
  explicit PoseManifold(const std::vector<int>& constant = {});

  bool Plus(const double* x, const double* d, double* moved) const override;

#ifdef RGBD_POSE_LOCAL_PARAMETERIZATION
  bool ComputeJacobian(const double* x, double* jacobian) const override {
    return Jacobian(x, jacobian);
  }
  int GlobalSize() const override { return PoseBlock::kSize; }
  int LocalSize() const override { return static_cast<int>(free_.size()); }
#else
  bool PlusJacobian(const double* x, double* jacobian) const override {
    return Jacobian(x, jacobian);
  }
  bool Minus(const double* y, const double* x, double* d) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
  int AmbientSize() const override { return PoseBlock::kSize; }
  int TangentSize() const override { return static_cast<int>(free_.size()); }
#endif

 private:
  bool Jacobian(const double* x, double* jacobian) const;

  std::vector<int> free_;  // the other directions
};

// Adds a pose that the solver may move. The manifold (null: a new one) belongs
// to the problem and may be shared by its poses.
inline void AddPose(double* pose, ceres::Problem* problem,
                    CeresManifold* manifold = nullptr) {
  problem->AddParameterBlock(
      pose, PoseBlock::kSize,
      manifold != nullptr ? manifold : new PoseManifold());
}

// The covariance of a pose after ceres::Covariance has computed it on a
// PoseManifold: of [omega C] as in MotionEstimate, of cam_from_world.
MotionMatrix PoseCovariance(const MotionMatrix& covariance_in_tangent);

}  // namespace rgbd_pose
