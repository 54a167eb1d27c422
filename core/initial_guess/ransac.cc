#include "core/initial_guess/ransac.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/util/counter_random.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

using Sample = std::array<uint32_t, 3>;

// The work of FindByRansac and its memory.
class Search {
 public:
  Search(const std::vector<PointMatch>& matches, const RansacOptions& options)
      : matches_(matches), options_(options) {
    inliers_.reserve(matches.size());
  }

  std::optional<Rigid3d> Run() {
    CounterRandom random(options_.seed);
    const auto count = static_cast<uint32_t>(matches_.size());
    int num_samples = options_.max_samples;
    for (int i = 0; i < num_samples; ++i) {
      const Sample sample = random.ThreeBelow(count);
      if (!CanBeRight(sample) || !Improve(FitToSample(sample))) continue;
      FindInliers(matches_, *best_, &inliers_);
      if (Improve(FitTo(matches_, inliers_))) {
        FindInliers(matches_, *best_, &inliers_);
      }
      num_samples = std::min(num_samples, SamplesNeeded(inliers_.size()));
    }
    return best_;
  }

 private:
  bool CanBeRight(const Sample& s) const {
    const double k = options_.max_distance_sigmas;
    return PreserveDistance(matches_[s[0]], matches_[s[1]], k) &&
           PreserveDistance(matches_[s[0]], matches_[s[2]], k) &&
           PreserveDistance(matches_[s[1]], matches_[s[2]], k);
  }

  std::optional<Rigid3d> FitToSample(const Sample& sample) const {
    PairMoments moments;
    for (const uint32_t i : sample) {
      moments.Add(matches_[i].cur.position, matches_[i].prev.position,
                  matches_[i].weight);
    }
    return FitRigidly(moments);
  }

  // Takes a motion if it is better than the best one so far, by the sum of
  // squared distances, each at most the greatest of an inlier (MSAC; Torr &
  // Zisserman 2000). Returns whether it was.
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
    const double needed = std::log(1.0 - options_.confidence) /
                          std::log1p(-share * share * share);
    return static_cast<int>(std::min<double>(needed, options_.max_samples)) + 1;
  }

  const std::vector<PointMatch>& matches_;
  const RansacOptions& options_;
  std::vector<int> inliers_;
  std::optional<Rigid3d> best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::string RansacOptions::Check() const {
  if (max_samples < 1) return "max_samples must be at least 1";
  if (!(confidence > 0.0 && confidence < 1.0)) {
    return "confidence must lie between 0 and 1";
  }
  if (!(max_distance_sigmas > 0.0)) {
    return "max_distance_sigmas must be positive";
  }
  if (max_matches < 3) return "max_matches must be at least 3";
  return consensus.Check();
}

std::optional<Consensus> FindByRansac(const Correspondences& matches,
                                      const RansacOptions& options) {
  const std::string problem = options.Check();
  if (!problem.empty()) throw InputError(problem);
  const std::vector<PointMatch> points =
      PointMatches(matches, options.max_matches);
  if (points.size() < 3) return std::nullopt;
  const std::optional<Rigid3d> best = Search(points, options).Run();
  if (!best) return std::nullopt;
  return FindConsensus(points, *best, options.consensus);
}

}  // namespace rgbd_pose
