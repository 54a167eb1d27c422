#include "core/evaluation/association.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>

namespace rgbd_pose {
namespace {

constexpr int kNone = -1;

// An entry of either list, chained to what is left before and after it.
struct Entry {
  double time;
  int index;  // in its own list
  bool in_first;
  int previous = kNone;
  int next = kNone;
  bool used = false;
};

// Both lists as one, in time order.
std::vector<Entry> MergeLists(const std::vector<double>& first,
                              const std::vector<double>& second) {
  std::vector<Entry> entries;
  for (size_t i = 0; i < first.size(); ++i) {
    entries.push_back({first[i], static_cast<int>(i), true});
  }
  for (size_t i = 0; i < second.size(); ++i) {
    entries.push_back({second[i], static_cast<int>(i), false});
  }
  std::stable_sort(
      entries.begin(), entries.end(),
      [](const Entry& a, const Entry& b) { return a.time < b.time; });
  for (size_t i = 1; i < entries.size(); ++i) {
    entries[i].previous = static_cast<int>(i - 1);
    entries[i - 1].next = static_cast<int>(i);
  }
  return entries;
}

}  // namespace

// Whatever lies between the two entries of a pair is nearer to one of them, so
// the nearest pair is always a pair of neighbours in time. Taking it out makes
// the entries around it neighbours.
std::vector<IndexPair> Associate(const std::vector<double>& first,
                                 const std::vector<double>& second,
                                 double max_difference) {
  std::vector<Entry> entries = MergeLists(first, second);
  using Candidate = std::tuple<double, int, int>;  // difference, two places
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>>
      nearest_first;
  const auto add_candidate = [&](int left, int right) {
    if (left == kNone || right == kNone) return;
    if (entries[left].in_first == entries[right].in_first) return;
    const double difference = entries[right].time - entries[left].time;
    if (difference <= max_difference) {
      nearest_first.emplace(difference, left, right);
    }
  };
  for (size_t i = 0; i < entries.size(); ++i) {
    add_candidate(static_cast<int>(i), entries[i].next);
  }

  std::vector<IndexPair> pairs;
  while (!nearest_first.empty()) {
    const auto [difference, left, right] = nearest_first.top();
    nearest_first.pop();
    Entry& a = entries[left];
    Entry& b = entries[right];
    if (a.used || b.used) continue;
    a.used = b.used = true;
    pairs.push_back(
        {a.in_first ? a.index : b.index, a.in_first ? b.index : a.index});
    if (a.previous != kNone) entries[a.previous].next = b.next;
    if (b.next != kNone) entries[b.next].previous = a.previous;
    add_candidate(a.previous, b.next);
  }
  std::sort(
      pairs.begin(), pairs.end(),
      [](const IndexPair& a, const IndexPair& b) { return a.first < b.first; });
  return pairs;
}

}  // namespace rgbd_pose
