#include "core/initial_guess/consensus.h"

#include <algorithm>
#include <utility>

#include "core/util/chi_squared.h"

namespace rgbd_pose {
namespace {

// How often a motion is refitted to the matches that agree with it.
constexpr int kRefits = 2;

}  // namespace

double MaxSquaredDistance() { return ChiSquared99(3); }

std::optional<Rigid3d> FitRigidTransform(const std::vector<PointMatch>& matches,
                                         const std::vector<int>& chosen) {
  PairMoments moments;
  for (const int i : chosen) {
    moments.Add(matches[i].cur.position, matches[i].prev.position,
                matches[i].weight);
  }
  return UmeyamaAlignment(moments);
}

void FindInliers(const std::vector<PointMatch>& matches,
                 const Rigid3d& cur_from_prev, std::vector<int>* inliers) {
  const Eigen::Matrix3d rotation = cur_from_prev.rotation.toRotationMatrix();
  inliers->clear();
  for (size_t i = 0; i < matches.size(); ++i) {
    const double distance =
        matches[i].SquaredDistance(rotation, cur_from_prev.translation);
    if (distance <= MaxSquaredDistance()) {
      inliers->push_back(static_cast<int>(i));
    }
  }
}

std::optional<Consensus> FindConsensus(const std::vector<PointMatch>& matches,
                                       const Rigid3d& cur_from_prev,
                                       const ConsensusOptions& options) {
  Consensus consensus{cur_from_prev, {}};
  FindInliers(matches, cur_from_prev, &consensus.inliers);
  for (int i = 0; i < kRefits; ++i) {
    const std::optional<Rigid3d> fit =
        FitRigidTransform(matches, consensus.inliers);
    if (!fit) return std::nullopt;
    consensus.cur_from_prev = *fit;
    FindInliers(matches, *fit, &consensus.inliers);
  }
  const double required = std::max<double>(
      options.min_inliers, options.min_inlier_share * matches.size());
  if (consensus.inliers.size() < required) return std::nullopt;
  for (int& inlier : consensus.inliers) inlier = matches[inlier].index;
  return consensus;
}

}  // namespace rgbd_pose
