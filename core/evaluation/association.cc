#include "core/evaluation/association.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <queue>
#include <set>
#include <string>
#include <tuple>

#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// An entry of either list.
struct Entry {
  double time;
  int index;  // in its own list
  bool in_first;
};

std::string TimeRange(const std::vector<double>& times) {
  if (times.empty()) return "no poses";
  return Format("%.6f s to %.6f s", times.front(), times.back());
}

}  // namespace

// Any entry between the two entries of a pair is nearer to one of them; hence
// the nearest pair consists of neighbours in time, also among what remains.
std::vector<IndexPair> Associate(const std::vector<double>& first,
                                 const std::vector<double>& second,
                                 double max_difference) {
  std::vector<Entry> entries;  // of both lists, in time order
  for (const bool in_first : {true, false}) {
    int index = 0;
    for (const double time : in_first ? first : second) {
      entries.push_back({time, index++, in_first});
    }
  }
  std::stable_sort(
      entries.begin(), entries.end(),
      [](const Entry& a, const Entry& b) { return a.time < b.time; });
  using Candidate = std::tuple<double, int, int>;  // difference, two entries
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>>
      nearest_first;
  const auto add_candidate = [&](int left, int right) {
    if (entries[left].in_first == entries[right].in_first) return;
    const double difference = entries[right].time - entries[left].time;
    if (difference <= max_difference) {
      nearest_first.emplace(difference, left, right);
    }
  };
  std::set<int> remaining;  // entries
  for (int i = 0; i < static_cast<int>(entries.size()); ++i) {
    remaining.insert(remaining.end(), i);
    if (i > 0) add_candidate(i - 1, i);
  }

  std::vector<IndexPair> pairs;
  while (!nearest_first.empty()) {
    const auto [difference, left, right] = nearest_first.top();
    nearest_first.pop();
    if (remaining.count(left) == 0 || remaining.count(right) == 0) continue;
    const Entry& a = entries[left];
    const Entry& b = entries[right];
    pairs.emplace_back(a.in_first ? a.index : b.index,
                       a.in_first ? b.index : a.index);
    remaining.erase(left);
    const auto after = remaining.erase(remaining.find(right));
    if (after != remaining.begin() && after != remaining.end()) {
      add_candidate(*std::prev(after), *after);
    }
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
