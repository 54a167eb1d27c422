#include "apps/pipeline/keyframe_links.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

// What is so near to each other stays near when one between them goes.
constexpr int kHopsAround = 3;

}  // namespace

void KeyframeLinks::Join(int a, int b) {
  beside_[a].push_back(b);
  beside_[b].push_back(a);
}

void KeyframeLinks::Separate(int at) {
  for (const int other : beside_[at]) {
    std::vector<int>& theirs = beside_[other];
    theirs.erase(std::remove(theirs.begin(), theirs.end(), at), theirs.end());
  }
  beside_[at].clear();
}

bool KeyframeLinks::AreJoined(int a, int b) const {
  return std::find(beside_[a].begin(), beside_[a].end(), b) != beside_[a].end();
}

std::vector<bool> KeyframeLinks::Within(int from, int hops) const {
  std::vector<bool> seen(beside_.size(), false);
  std::vector<int> reached = {from};
  seen[from] = true;
  size_t next = 0;
  for (int hop = 0; hop < hops; ++hop) {
    for (const size_t end = reached.size(); next < end; ++next) {
      for (const int other : beside_[reached[next]]) {
        if (!seen[other]) reached.push_back(other);
        seen[other] = true;
      }
    }
  }
  return seen;
}

int KeyframeLinks::Hops(int from, int to, int most) const {
  std::vector<int> reached = {from};
  std::vector<bool> seen(beside_.size(), false);
  seen[from] = true;
  for (int hops = 0; hops < most; ++hops) {
    std::vector<int> next;
    for (const int at : reached) {
      if (at == to) return hops;
      for (const int other : beside_[at]) {
        if (!seen[other]) next.push_back(other);
        seen[other] = true;
      }
    }
    reached = std::move(next);
  }
  return most;
}

std::vector<int> KeyframeLinks::Way(int from, int to) const {
  std::vector<int> before(beside_.size(), -1), reached = {from};
  before[from] = from;
  for (size_t i = 0; i < reached.size() && before[to] < 0; ++i) {
    for (const int other : beside_[reached[i]]) {
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

bool KeyframeLinks::HoldWithout(int without) const {
  const std::vector<int>& around = beside_[without];
  if (around.empty()) return false;
  std::vector<int> reached = {around.front()};
  std::vector<bool> seen(beside_.size(), false);
  seen[without] = seen[around.front()] = true;
  for (int hops = 0; hops < kHopsAround; ++hops) {
    const size_t end = reached.size();
    for (size_t i = 0; i < end; ++i) {
      for (const int other : beside_[reached[i]]) {
        if (!seen[other]) reached.push_back(other);
        seen[other] = true;
      }
    }
  }
  return std::all_of(around.begin(), around.end(),
                     [&](int at) { return seen[at]; });
}

}  // namespace rgbd_pose
