#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/closed_form.h"
#include "core/geometry/rigid3.h"
#include "core/util/quantile.h"

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
  // previous frame is taken along the same axes: exact but for the parallax.
  Eigen::Vector3d inverse_sigma = Eigen::Vector3d::Zero();
  Eigen::Vector2d ray = Eigen::Vector2d::Zero();

  // Mean inverse variance of one component of that difference, 1 / m^2.
  double weight = 0.0;

  // Squared whitened difference: chi^2 with 3 degrees of freedom if right.
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

// The matches with a depth on both sides, or `max_count` evenly spread ones.
std::vector<PointMatch> PointMatches(const Correspondences& matches,
                                     size_t max_count);

// Whether one motion can explain both matches: it must preserve the distance
// between their points, here within `max_sigmas` standard deviations of the
// difference (Hirschmueller, Innocent & Garibaldi 2002; Howard 2008).
bool AreDistanceConsistent(const PointMatch& a, const PointMatch& b,
                           double max_sigmas = 3.0);

// A motion and the matches that agree with it.
struct Consensus {
  Rigid3d cur_from_prev;
  std::vector<int> inliers;  // indices within the Correspondences, increasing
};

struct ConsensusOptions {
  // At least so many matches, and this share of those with depths, must agree.
  int min_inliers = 6;
  double min_inlier_share = 0.1;
};

// The largest squared whitened distance of an inlier: 99 % are below it.
constexpr double kMaxSquaredDistance = ChiSquared99(3);

// The closed-form motion of the matches at these indices.
template <typename Indices>
std::optional<Rigid3d> FitRigidTransform(const std::vector<PointMatch>& matches,
                                         const Indices& chosen) {
  PairMoments moments;
  for (const auto i : chosen) {
    moments.Add(matches[i].cur.position, matches[i].prev.position,
                matches[i].weight);
  }
  return UmeyamaAlignment(moments);
}

// The indices of the matches that agree with a motion.
std::vector<int> FindInliers(const std::vector<PointMatch>& matches,
                             const Rigid3d& cur_from_prev);

// Refits a motion several times to the matches that agree with it. Empty if
// there is none, too few agree, or they leave the motion undetermined.
std::optional<Consensus> FindConsensus(const std::vector<PointMatch>& matches,
                                       std::optional<Rigid3d> cur_from_prev,
                                       const ConsensusOptions& options);

// The motion that most matches agree with, by random samples of three matches
// (Fischler & Bolles 1981). Each new best motion is refitted to its inliers
// (Chum, Matas & Kittler 2003). Distances are whitened by the noise of both
// frames. Reproducible bit by bit. Ignores matches without a depth on both
// sides; empty as FindConsensus.
std::optional<Consensus> FindByRansac(const Correspondences& matches,
                                      const ConsensusOptions& options = {});

// The motion of a large set of matches that are all consistent with each other,
// found greedily: the match with the most consistent partners first, then the
// next that is consistent with all taken so far (Howard, "Real-time stereo
// visual odometry for autonomous ground vehicles", IROS 2008). Ties go to the
// earlier match. Ignores and empty as FindByRansac.
std::optional<Consensus> FindByClique(const Correspondences& matches);

}  // namespace rgbd_pose
