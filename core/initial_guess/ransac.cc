#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
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

constexpr uint64_t kSeed = 1;

using Sample = std::array<uint32_t, 3>;

// The implementation of FindByRansac and its memory.
class Search {
 public:
  explicit Search(const std::vector<PointMatch>& matches) : matches_(matches) {
    inliers_.reserve(matches.size());
  }

  std::optional<Rigid3d> Run() {
    CounterRandom random(kSeed);
    const auto count = static_cast<uint32_t>(matches_.size());
    int num_samples = kMaxSamples;
    for (int i = 0; i < num_samples; ++i) {
      const Sample sample = random.ThreeBelow(count);
      if (!CanBeRight(sample) || !Improve(FitToSample(sample))) continue;
      FindInliers(matches_, *best_, &inliers_);
      if (Improve(FitRigidTransform(matches_, inliers_))) {
        FindInliers(matches_, *best_, &inliers_);
      }
      num_samples = std::min(num_samples, SamplesNeeded(inliers_.size()));
    }
    return best_;
  }

 private:
  bool CanBeRight(const Sample& s) const {
    return AreDistanceConsistent(matches_[s[0]], matches_[s[1]]) &&
           AreDistanceConsistent(matches_[s[0]], matches_[s[2]]) &&
           AreDistanceConsistent(matches_[s[1]], matches_[s[2]]);
  }

  std::optional<Rigid3d> FitToSample(const Sample& sample) const {
    PairMoments moments;
    for (const uint32_t i : sample) {
      moments.Add(matches_[i].cur.position, matches_[i].prev.position,
                  matches_[i].weight);
    }
    return UmeyamaAlignment(moments);
  }

  // Takes a motion if it is better than the best one so far, by the sum of
  // squared distances, each limited to the maximum of an inlier (MSAC; Torr &
  // Zisserman 2000). Returns whether it was better.
  bool Improve(const std::optional<Rigid3d>& motion) {
    if (!motion) return false;
    const Eigen::Matrix3d rotation = motion->rotation.toRotationMatrix();
    double cost = 0.0;
    for (const PointMatch& match : matches_) {
      cost += std::min(match.SquaredDistance(rotation, motion->translation),
                       MaxSquaredDistance());
      if (cost >= best_cost_) return false;
    }
    best_cost_ = cost;
    best_ = motion;
    return true;
  }

  int SamplesNeeded(size_t inliers) const {
    const double share = static_cast<double>(inliers) / matches_.size();
    const double needed =
        std::log(1.0 - kConfidence) / std::log1p(-share * share * share);
    return static_cast<int>(std::min<double>(needed, kMaxSamples)) + 1;
  }

  const std::vector<PointMatch>& matches_;
  std::vector<int> inliers_;
  std::optional<Rigid3d> best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::optional<Consensus> FindByRansac(const Correspondences& matches,
                                      const ConsensusOptions& options) {
  const std::vector<PointMatch> points = PointMatches(matches, kMaxMatches);
  if (points.size() < 3) return std::nullopt;
  const std::optional<Rigid3d> best = Search(points).Run();
  if (!best) return std::nullopt;
  return FindConsensus(points, *best, options);
}

}  // namespace rgbd_pose
