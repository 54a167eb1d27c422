#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/initial_guess/consensus.h"

namespace rgbd_pose {
namespace {

// Maximum number of matches, evenly spread: time and memory grow with its
// square.
constexpr int kMaxMatches = 500;

// Consistency of all pairs of matches, one row of bits per match.
class ConsistencyGraph {
 public:
  explicit ConsistencyGraph(const std::vector<PointMatch>& matches)
      : size_(matches.size()),
        words_((size_ + 63) / 64),
        bits_(size_ * words_),
        degrees_(size_) {
    for (size_t i = 0; i < size_; ++i) {
      for (size_t j = 0; j < i; ++j) {
        if (AreDistanceConsistent(matches[i], matches[j])) {
          Connect(i, j);
          Connect(j, i);
        }
      }
    }
  }

  // Howard's greedy clique. Matches join in the order of their degrees; hence
  // one pass in that order is enough.
  std::vector<int> GreedyClique() const {
    std::vector<int> order(size_);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [this](int a, int b) {
      return degrees_[a] > degrees_[b];
    });
    std::vector<int> clique;
    std::vector<uint64_t> candidates(words_, ~uint64_t{0});
    for (const int i : order) {
      if ((candidates[i / 64] >> (i % 64) & 1) == 0) continue;
      clique.push_back(i);
      for (size_t w = 0; w < words_; ++w) {
        candidates[w] &= bits_[i * words_ + w];
      }
    }
    return clique;
  }

 private:
  void Connect(size_t i, size_t j) {
    bits_[i * words_ + j / 64] |= uint64_t{1} << (j % 64);
    ++degrees_[i];
  }

  size_t size_;
  size_t words_;  // of 64 bits, per row
  std::vector<uint64_t> bits_;
  std::vector<int> degrees_;
};

}  // namespace

std::optional<Consensus> FindByClique(const Correspondences& matches) {
  const std::vector<PointMatch> points = PointMatches(matches, kMaxMatches);
  const ConsistencyGraph graph(points);
  const std::optional<Rigid3d> fit =
      FitRigidTransform(points, graph.GreedyClique());
  if (!fit) return std::nullopt;
  return FindConsensus(points, *fit, {});
}

}  // namespace rgbd_pose
