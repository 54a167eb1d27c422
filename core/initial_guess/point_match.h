#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/closed_form.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A point in camera axes (m) and its noise along the measurement's own axes:
// sideways along u and v, and along the ray through the point.
struct NoisyPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double variance_u = 0.0;    // m^2
  double variance_v = 0.0;    // m^2
  double variance_ray = 0.0;  // of the relative error of the depth

  // direction^T covariance direction, for a direction of any length.
  double VarianceAlong(const Eigen::Vector3d& direction) const {
    const double along_ray = direction.dot(position);
    return variance_u * direction.x() * direction.x() +
           variance_v * direction.y() * direction.y() +
           variance_ray * along_ray * along_ray;
  }

  // The trace of the covariance, m^2.
  double TotalVariance() const {
    return variance_u + variance_v + variance_ray * position.squaredNorm();
  }
};

// A match with a depth on both sides.
struct PointMatch {
  int index = 0;  // index within the Correspondences
  NoisyPoint prev;
  NoisyPoint cur;

  // Whitens cur - cur_from_prev * prev: inverse sigmas along u, v and z of the
  // current frame (1 / m), and the ray (x / z, y / z) there. The noise of the
  // previous frame is taken along the same axes, which makes it independent of
  // the motion. This is exact except for the parallax between the two rays.
  Eigen::Vector3d inverse_sigma = Eigen::Vector3d::Zero();
  Eigen::Vector2d ray = Eigen::Vector2d::Zero();

  // Mean inverse variance of one component of that difference, 1 / m^2.
  double weight = 0.0;

  // Squared norm of the whitened difference: chi^2 with three degrees of
  // freedom for right matches.
  double SquaredDistance(const Eigen::Matrix3d& rotation,
                         const Eigen::Vector3d& translation) const {
    const Eigen::Vector3d e =
        rotation * prev.position + translation - cur.position;
    const double u = inverse_sigma.x() * (e.x() - ray.x() * e.z());
    const double v = inverse_sigma.y() * (e.y() - ray.y() * e.z());
    const double z = inverse_sigma.z() * e.z();
    return u * u + v * v + z * z;
  }
};

// The matches with a depth on both sides: all of them, or `max_count` evenly
// spread over the list.
std::vector<PointMatch> PointMatches(const Correspondences& matches,
                                     size_t max_count);

// Whether one motion can explain both matches: it must preserve the distance
// between their points, here within `max_sigmas` standard deviations of the
// difference (Hirschmueller, Innocent & Garibaldi 2002; Howard 2008).
bool AreDistanceConsistent(const PointMatch& a, const PointMatch& b,
                           double max_sigmas = 3.0);

}  // namespace rgbd_pose
