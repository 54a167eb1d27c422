#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/initial_guess/consensus.h"
#include "core/util/counter_random.h"

namespace rgbd_pose {
namespace {

constexpr int kMaxSamples = 500;  // of three matches

// Sampling stops when, at the largest share of inliers so far, a sample of
// inliers only has been drawn with this probability.
constexpr double kConfidence = 0.999;

// Maximum number of matches, evenly spread over the list.
constexpr int kMaxMatches = 1000;

// How many samples are needed if this share of the matches are inliers.
int SamplesNeeded(double share) {
  const double needed =
      std::log(1.0 - kConfidence) / std::log1p(-share * share * share);
  return static_cast<int>(std::min<double>(needed, kMaxSamples)) + 1;
}

std::optional<Rigid3d> BestOfSamples(const std::vector<PointMatch>& matches) {
  std::optional<Rigid3d> best;
  double best_cost = INFINITY;
  // Takes a motion and returns true if the sum of squared distances, each
  // limited to that of an inlier, is smaller (MSAC; Torr & Zisserman 2000).
  const auto improve = [&](const std::optional<Rigid3d>& motion) {
    if (!motion) return false;
    const Eigen::Matrix3d rotation = motion->rotation.toRotationMatrix();
    double cost = 0.0;
    for (const PointMatch& match : matches) {
      cost += std::min(match.SquaredDistance(rotation, motion->translation),
                       kMaxSquaredDistance);
      if (cost >= best_cost) return false;
    }
    best_cost = cost;
    best = motion;
    return true;
  };
  CounterRandom random(1);
  int num_samples = kMaxSamples;
  for (int i = 0; i < num_samples; ++i) {
    const auto sample =
        random.ThreeBelow(static_cast<uint32_t>(matches.size()));
    const auto& [a, b, c] = sample;
    if (!AreDistanceConsistent(matches[a], matches[b]) ||
        !AreDistanceConsistent(matches[a], matches[c]) ||
        !AreDistanceConsistent(matches[b], matches[c]) ||
        !improve(FitRigidTransform(matches, sample))) {
      continue;
    }
    std::vector<int> inliers = FindInliers(matches, *best);
    if (improve(FitRigidTransform(matches, inliers))) {
      inliers = FindInliers(matches, *best);
    }
    const double share = static_cast<double>(inliers.size()) / matches.size();
    num_samples = std::min(num_samples, SamplesNeeded(share));
  }
  return best;
}

}  // namespace

std::optional<Consensus> FindByRansac(const Correspondences& matches,
                                      const ConsensusOptions& options) {
  const std::vector<PointMatch> points = PointMatches(matches, kMaxMatches);
  if (points.size() < 3) return std::nullopt;
  return FindConsensus(points, BestOfSamples(points), options);
}

}  // namespace rgbd_pose
