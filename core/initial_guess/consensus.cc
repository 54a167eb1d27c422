#include "core/initial_guess/consensus.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbd_pose {
namespace {

bool HasDepths(const Match& match) {
  return match.prev.depth > 0.0 && match.cur.depth > 0.0;
}

NoisyPoint MakeNoisyPoint(const Correspondences& matches,
                          const Observation& o) {
  const double sigma_u = o.depth * o.sigma_px / matches.camera().fx;
  const double sigma_v = o.depth * o.sigma_px / matches.camera().fy;
  const double sigma_ray = o.sigma_depth / o.depth;
  return {matches.Point(o), sigma_u * sigma_u, sigma_v * sigma_v,
          sigma_ray * sigma_ray};
}

PointMatch MakePointMatch(const Correspondences& matches, size_t i) {
  const Observation& prev = matches[i].prev;
  const Observation& cur = matches[i].cur;
  PointMatch match;
  match.index = static_cast<int>(i);
  match.prev = MakeNoisyPoint(matches, prev);
  match.cur = MakeNoisyPoint(matches, cur);
  match.inverse_sigma = {
      1.0 / std::sqrt(match.prev.variance_u + match.cur.variance_u),
      1.0 / std::sqrt(match.prev.variance_v + match.cur.variance_v),
      1.0 / std::hypot(prev.sigma_depth, cur.sigma_depth)};
  match.ray = match.cur.position.head<2>() / cur.depth;
  match.weight = 3.0 / (match.prev.TotalVariance() + match.cur.TotalVariance());
  return match;
}

// Variance of the length of the vector between two points.
double VarianceOfLength(const NoisyPoint& a, const NoisyPoint& b,
                        const Eigen::Vector3d& a_from_b) {
  constexpr double kNotZero = std::numeric_limits<double>::min();
  return (a.VarianceAlong(a_from_b) + b.VarianceAlong(a_from_b)) /
         std::max(a_from_b.squaredNorm(), kNotZero);
}

}  // namespace

std::vector<PointMatch> PointMatches(const Correspondences& matches,
                                     size_t max_count) {
  const size_t count = std::count_if(matches.begin(), matches.end(), HasDepths);
  const size_t wanted = std::min(count, max_count);

  std::vector<PointMatch> points;
  points.reserve(wanted);
  size_t place = 0;  // among matches with depths
  for (size_t i = 0; i < matches.size(); ++i) {
    if (!HasDepths(matches[i])) continue;
    ++place;
    if (place * wanted / count > points.size()) {
      points.push_back(MakePointMatch(matches, i));
    }
  }
  return points;
}

bool AreDistanceConsistent(const PointMatch& a, const PointMatch& b,
                           double max_sigmas) {
  const Eigen::Vector3d prev = a.prev.position - b.prev.position;
  const Eigen::Vector3d cur = a.cur.position - b.cur.position;
  const double change = cur.norm() - prev.norm();
  const double variance = VarianceOfLength(a.prev, b.prev, prev) +
                          VarianceOfLength(a.cur, b.cur, cur);
  return change * change <= max_sigmas * max_sigmas * variance;
}

std::vector<int> FindInliers(const std::vector<PointMatch>& matches,
                             const Rigid3d& cur_from_prev) {
  const Eigen::Matrix3d rotation = cur_from_prev.rotation.toRotationMatrix();
  std::vector<int> inliers;
  for (size_t i = 0; i < matches.size(); ++i) {
    const double distance =
        matches[i].SquaredDistance(rotation, cur_from_prev.translation);
    if (distance <= kMaxSquaredDistance) inliers.push_back(static_cast<int>(i));
  }
  return inliers;
}

std::optional<Consensus> FindConsensus(const std::vector<PointMatch>& matches,
                                       std::optional<Rigid3d> cur_from_prev,
                                       const ConsensusOptions& options) {
  constexpr int kRefits = 2;
  std::vector<int> inliers;
  for (int i = 0; cur_from_prev && i <= kRefits; ++i) {
    inliers = FindInliers(matches, *cur_from_prev);
    if (i < kRefits) cur_from_prev = FitRigidTransform(matches, inliers);
  }
  const double required = std::max<double>(
      options.min_inliers, options.min_inlier_share * matches.size());
  if (!cur_from_prev || inliers.size() < required) return std::nullopt;
  for (int& inlier : inliers) inlier = matches[inlier].index;
  return Consensus{*cur_from_prev, inliers};
}

}  // namespace rgbd_pose
