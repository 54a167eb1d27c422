#include "frontend/mapping/covisibility_graph.h"

#include <algorithm>

namespace rgbd_pose {

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

std::vector<int> CovisibilityGraph::Reach(int from, std::vector<int>* before,
                                          int hops) const {
  std::vector<int> reached = {from};
  (*before)[from] = from;
  size_t next = 0;
  for (int hop = 0; hop < hops && next < reached.size(); ++hop) {
    for (const size_t end = reached.size(); next < end; ++next) {
      const int at = reached[next];
      for (const int other : neighbors_[at]) {
        if ((*before)[other] >= 0) continue;
        (*before)[other] = at;
        reached.push_back(other);
      }
    }
  }
  return reached;
}

std::vector<bool> CovisibilityGraph::Within(int from, int hops) const {
  std::vector<int> before(neighbors_.size(), -1);
  std::vector<bool> within(neighbors_.size(), false);
  for (const int at : Reach(from, &before, hops)) within[at] = true;
  return within;
}

std::vector<int> CovisibilityGraph::ShortestPath(int from, int to) const {
  std::vector<int> before(neighbors_.size(), -1);
  Reach(from, &before);
  if (before[to] < 0) return {};
  std::vector<int> way = {to};
  while (way.back() != from) way.push_back(before[way.back()]);
  std::reverse(way.begin(), way.end());
  return way;
}

std::vector<int> CovisibilityGraph::FirstOfParts() const {
  std::vector<int> first(neighbors_.size()), before(neighbors_.size(), -1);
  for (int from = 0; from < static_cast<int>(first.size()); ++from) {
    if (before[from] >= 0) continue;
    for (const int at : Reach(from, &before)) first[at] = from;
  }
  return first;
}

bool CovisibilityGraph::StaysConnectedWithout(int without) const {
  constexpr int kHopsAround = 3;
  const std::vector<int>& around = neighbors_[without];
  if (around.empty()) return false;
  std::vector<int> before(neighbors_.size(), -1);
  before[without] = without;
  Reach(around.front(), &before, kHopsAround);
  return std::all_of(around.begin(), around.end(),
                     [&](int at) { return before[at] >= 0; });
}

}  // namespace rgbd_pose
