#include "frontend/mapping/covisibility_graph.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

// Neighbours of a keyframe are near each other within this many links.
constexpr int kHopsAround = 3;

}  // namespace

void CovisibilityGraph::Join(int a, int b) {
  neighbors_[a].push_back(b);
  neighbors_[b].push_back(a);
}

void CovisibilityGraph::Separate(int at) {
  for (const int other : neighbors_[at]) {
    std::vector<int>& theirs = neighbors_[other];
    theirs.erase(std::remove(theirs.begin(), theirs.end(), at), theirs.end());
  }
  neighbors_[at].clear();
}

bool CovisibilityGraph::AreJoined(int a, int b) const {
  return std::find(neighbors_[a].begin(), neighbors_[a].end(), b) !=
         neighbors_[a].end();
}

std::vector<int> CovisibilityGraph::Distances(int from, int most,
                                              int without) const {
  std::vector<int> distances(neighbors_.size(), -1), reached = {from};
  distances[from] = 0;
  for (size_t i = 0; i < reached.size(); ++i) {
    const int at = reached[i];
    if (distances[at] == most) break;
    for (const int other : neighbors_[at]) {
      if (distances[other] >= 0 || other == without) continue;
      distances[other] = distances[at] + 1;
      reached.push_back(other);
    }
  }
  return distances;
}

std::vector<bool> CovisibilityGraph::Within(int from, int hops) const {
  std::vector<bool> within;
  for (const int distance : Distances(from, hops)) {
    within.push_back(distance >= 0);
  }
  return within;
}

int CovisibilityGraph::Hops(int from, int to, int most) const {
  const int distance = Distances(from, most)[to];
  return distance >= 0 ? distance : most;
}

std::vector<int> CovisibilityGraph::ShortestPath(int from, int to) const {
  std::vector<int> before(neighbors_.size(), -1), reached = {from};
  before[from] = from;
  for (size_t i = 0; i < reached.size() && before[to] < 0; ++i) {
    for (const int other : neighbors_[reached[i]]) {
      if (before[other] >= 0) continue;
      before[other] = reached[i];
      reached.push_back(other);
    }
  }
  if (before[to] < 0) return {};
  std::vector<int> way = {to};
  while (way.back() != from) way.push_back(before[way.back()]);
  std::reverse(way.begin(), way.end());
  return way;
}

std::vector<int> CovisibilityGraph::FirstOfParts() const {
  std::vector<int> first(neighbors_.size(), -1), reached;
  for (size_t from = 0; from < first.size(); ++from) {
    if (first[from] >= 0) continue;
    first[from] = static_cast<int>(from);
    reached = {first[from]};
    for (size_t i = 0; i < reached.size(); ++i) {
      for (const int other : neighbors_[reached[i]]) {
        if (first[other] >= 0) continue;
        first[other] = first[from];
        reached.push_back(other);
      }
    }
  }
  return first;
}

bool CovisibilityGraph::StaysConnectedWithout(int without) const {
  const std::vector<int>& around = neighbors_[without];
  if (around.empty()) return false;
  const std::vector<int> near = Distances(around.front(), kHopsAround, without);
  return std::all_of(around.begin(), around.end(),
                     [&](int at) { return near[at] >= 0; });
}

}  // namespace rgbd_pose
