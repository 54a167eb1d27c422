#include "frontend/mapping/covisibility_graph.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

// What is so near to each other stays near when one between them goes.
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

std::vector<bool> CovisibilityGraph::Within(int from, int hops) const {
  std::vector<bool> seen(neighbors_.size(), false);
  std::vector<int> reached = {from};
  seen[from] = true;
  size_t next = 0;
  for (int hop = 0; hop < hops; ++hop) {
    for (const size_t end = reached.size(); next < end; ++next) {
      for (const int other : neighbors_[reached[next]]) {
        if (!seen[other]) reached.push_back(other);
        seen[other] = true;
      }
    }
  }
  return seen;
}

int CovisibilityGraph::Hops(int from, int to, int most) const {
  std::vector<int> reached = {from};
  std::vector<bool> seen(neighbors_.size(), false);
  seen[from] = true;
  for (int hops = 0; hops < most; ++hops) {
    std::vector<int> next;
    for (const int at : reached) {
      if (at == to) return hops;
      for (const int other : neighbors_[at]) {
        if (!seen[other]) next.push_back(other);
        seen[other] = true;
      }
    }
    reached = std::move(next);
  }
  return most;
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
  std::vector<int> reached = {around.front()};
  std::vector<bool> seen(neighbors_.size(), false);
  seen[without] = seen[around.front()] = true;
  for (int hops = 0; hops < kHopsAround; ++hops) {
    const size_t end = reached.size();
    for (size_t i = 0; i < end; ++i) {
      for (const int other : neighbors_[reached[i]]) {
        if (!seen[other]) reached.push_back(other);
        seen[other] = true;
      }
    }
  }
  return std::all_of(around.begin(), around.end(),
                     [&](int at) { return seen[at]; });
}

}  // namespace rgbd_pose
