#include <algorithm>
#include <bitset>
#include <numeric>
#include <vector>

#include "core/initial_guess/consensus.h"

namespace rgbd_pose {
namespace {

// Evenly spread: time and memory grow with the square.
constexpr int kMaxCliqueMatches = 500;

// Howard's greedy clique: matches join in the order of their degrees.
std::vector<int> GreedyClique(const std::vector<PointMatch>& matches) {
  std::vector<std::bitset<kMaxCliqueMatches>> graph(matches.size());
  for (size_t i = 0; i < matches.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      graph[i][j] = graph[j][i] = AreDistanceConsistent(matches[i], matches[j]);
    }
  }
  std::vector<int> order(graph.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<size_t> degrees;
  for (const auto& consistent : graph) degrees.push_back(consistent.count());
  std::stable_sort(order.begin(), order.end(), [&degrees](int a, int b) {
    return degrees[a] > degrees[b];
  });
  std::vector<int> clique;
  std::bitset<kMaxCliqueMatches> candidates;
  candidates.set();
  for (const int i : order) {
    if (!candidates[i]) continue;
    clique.push_back(i);
    candidates &= graph[i];
  }
  return clique;
}

}  // namespace

std::optional<Consensus> FindByClique(const Correspondences& matches) {
  const std::vector<PointMatch> points =
      PointMatches(matches, kMaxCliqueMatches);
  return FindConsensus(points, FitRigidTransform(points, GreedyClique(points)),
                       {});
}

}  // namespace rgbd_pose
