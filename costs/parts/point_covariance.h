#pragma once

#include <Eigen/Core>

#include "core/estimation/correspondences.h"

namespace rgbd_pose {

// Covariance (m^2) of the point of an observation with depth, from the noise
// of u, v and depth to first order (Khoshelham & Elberink 2012). With the ray
// (a, b, 1):
//
//   S = z^2 sigma_px^2 diag(1/fx^2, 1/fy^2, 0) + sigma_depth^2 ray ray^T
//
// ray_whitening.h is its inverse square root.
inline Eigen::Matrix3d PointCovariance(const Camera& camera,
                                       const Observation& o) {
  const Eigen::Vector3d ray = camera.Ray(o.u, o.v);
  const Eigen::Vector3d image(o.depth * o.sigma_px / camera.fx,
                              o.depth * o.sigma_px / camera.fy, 0.0);
  Eigen::Matrix3d S = o.sigma_depth * o.sigma_depth * (ray * ray.transpose());
  S.diagonal() += image.cwiseAbs2();
  return S;
}

}  // namespace rgbd_pose
