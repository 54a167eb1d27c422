#include "core/evaluation/association.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <string>
#include <tuple>

#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

constexpr int kNone = -1;

// An entry of either list, linked to the remaining entries before and after it.
struct Entry {
  double time;
  int index;  // in its own list
  bool in_first;
  int previous = kNone;
  int next = kNone;
  bool used = false;
};

// Merges both lists in time order.
std::vector<Entry> MergeLists(const std::vector<double>& first,
                              const std::vector<double>& second) {
  std::vector<Entry> entries;
  for (const bool in_first : {true, false}) {
    int index = 0;
    for (const double time : in_first ? first : second) {
      entries.push_back({time, index++, in_first});
    }
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

std::string TimeRange(const std::vector<double>& times) {
  if (times.empty()) return "no poses";
  return Format("%.6f s to %.6f s", times.front(), times.back());
}

}  // namespace

// Any entry between the two entries of a pair is nearer to one of them; hence
// the nearest pair always consists of neighbours in time. After removing it,
// the entries around it are neighbours.
std::vector<IndexPair> Associate(const std::vector<double>& first,
                                 const std::vector<double>& second,
                                 double max_difference) {
  std::vector<Entry> entries = MergeLists(first, second);
  using Candidate = std::tuple<double, int, int>;  // difference, two indices
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
    pairs.emplace_back(a.in_first ? a.index : b.index,
                       a.in_first ? b.index : a.index);
    if (a.previous != kNone) entries[a.previous].next = b.next;
    if (b.next != kNone) entries[b.next].previous = a.previous;
    add_candidate(a.previous, b.next);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

size_t NearestTime(const std::vector<double>& times, double time) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return 0;
  const auto before = after - 1;
  const bool before_is_nearest =
      after == times.end() || time - *before <= *after - time;
  return (before_is_nearest ? before : after) - times.begin();
}

std::vector<PosePair> PairPoses(const Trajectory& estimate,
                                const Trajectory& ground_truth,
                                double max_time_difference) {
  const std::vector<double> estimate_times = TimesOf(estimate);
  const std::vector<double> truth_times = TimesOf(ground_truth);
  std::vector<PosePair> pairs;
  for (const auto& [i, j] :
       Associate(estimate_times, truth_times, max_time_difference)) {
    pairs.push_back({estimate_times[i], ground_truth[j].world_from_cam,
                     estimate[i].world_from_cam});
  }
  if (pairs.empty()) {
    throw InputError("no pose of the estimate (" + TimeRange(estimate_times) +
                     ") is within " + Format("%g", max_time_difference) +
                     " s of one of the ground truth (" +
                     TimeRange(truth_times) +
                     "); check that both belong to the same sequence");
  }
  return pairs;
}

}  // namespace rgbd_pose
