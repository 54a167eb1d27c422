#include <algorithm>
#include <map>
#include <utility>

#include "apps/calibration/calibration_data.h"

namespace rgbd_pose {
namespace {

// The work grows with the third power of their number.
constexpr size_t kMaxKeyframes = 300;

// Every n-th pair is kept to judge the result by.
constexpr int kHoldOut = 5;

// The largest segment's keyframes, by their places in the map.
std::vector<int> ChosenKeyframes(const KeyframeMap& map) {
  std::map<int, std::vector<int>> segments;
  for (size_t i = 0; i < map.keyframes.size(); ++i) {
    segments[map.keyframes[i].segment].push_back(static_cast<int>(i));
  }
  std::vector<int> largest;
  for (const auto& [segment, members] : segments) {
    if (members.size() > largest.size()) largest = members;
  }
  std::sort(largest.begin(), largest.end(), [&](int a, int b) {
    return map.keyframes[a].images.timestamp <
           map.keyframes[b].images.timestamp;
  });
  if (largest.size() <= kMaxKeyframes) return largest;
  std::vector<int> chosen;
  for (size_t i = 0; i < kMaxKeyframes; ++i) {
    chosen.push_back(largest[i * largest.size() / kMaxKeyframes]);
  }
  return chosen;
}

// Every n-th pair, but none that two keyframes hang together by.
std::vector<bool> HeldOut(int num_keyframes,
                          const std::vector<std::array<int, 2>>& pairs) {
  std::vector<int> root(num_keyframes);
  for (int i = 0; i < num_keyframes; ++i) root[i] = i;
  const auto find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::vector<bool> held_out(pairs.size(), false);
  std::vector<size_t> spare;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const int a = find(pairs[i][0]), b = find(pairs[i][1]);
    if (a == b) {
      spare.push_back(i);
    } else {
      root[a] = b;
    }
  }
  // One in kHoldOut of all, as far as there are any to spare.
  const double step = std::max(
      1.0, static_cast<double>(spare.size()) * kHoldOut / pairs.size());
  for (double i = 0.0; i < spare.size(); i += step) {
    held_out[spare[static_cast<size_t>(i)]] = true;
  }
  return held_out;
}

}  // namespace

CalibrationPairs ChoosePairs(const KeyframeMap& map) {
  CalibrationPairs result;
  result.in_map = ChosenKeyframes(map);
  const int num_keyframes = static_cast<int>(result.in_map.size());
  std::map<int, int> number_of;  // by the map's id
  for (int i = 0; i < num_keyframes; ++i) {
    number_of[map.keyframes[result.in_map[i]].id] = i;
  }
  for (const RelativePose& edge : map.edges) {
    const auto a = number_of.find(edge.ref), b = number_of.find(edge.cur);
    if (a == number_of.end() || b == number_of.end()) continue;
    result.pairs.push_back(
        {std::min(a->second, b->second), std::max(a->second, b->second)});
  }
  std::sort(result.pairs.begin(), result.pairs.end(), [](auto& a, auto& b) {
    return std::make_pair(a[1] - a[0], a[0]) <
           std::make_pair(b[1] - b[0], b[0]);
  });
  result.pairs.erase(std::unique(result.pairs.begin(), result.pairs.end()),
                     result.pairs.end());
  result.is_held_out = HeldOut(num_keyframes, result.pairs);
  return result;
}

}  // namespace rgbd_pose
