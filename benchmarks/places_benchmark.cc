// Cost of the index of places as the map grows: one query, one addition.
//
// Names: places/<query or add>/<keyframes>/iterations:<how many>.

#include <benchmark/benchmark.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <vector>

#include "frontend/places/place_database.h"
#include "frontend/places/place_features.h"
#include "frontend/simulation/synthetic_dataset.h"

namespace rgbd_pose {
namespace {

constexpr int kRows = 800;  // descriptors per keyframe
constexpr int kViews = 60;

// All descriptors of views around the simulated tables. Real ORB bits are
// neither uniform nor independent.
const cv::Mat& Seen() {
  static const cv::Mat seen = [] {
    SyntheticOptions options;
    options.scene = "table";
    options.path = "table";
    options.rate_hz = kViews / 56.0;
    options.frames = kViews;
    options.camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5, 0, 0, 0};
    const SyntheticDataset dataset(options);
    cv::Mat all;
    for (int i = 0; i < kViews; ++i) {
      all.push_back(DescribeKeyframe(PreparedFrame(dataset.Read(i)),
                                     {options.camera.camera})
                        .described.descriptors);
    }
    return all;
  }();
  return seen;
}

// A keyframe of a distinct place: it combines words of real descriptors, so
// that buckets fill as unevenly as with real keyframes, and redraws two bits of
// each word.
cv::Mat Keyframe(int seed) {
  std::mt19937 rng(seed);
  cv::Mat rows(kRows, 32, CV_8U);
  for (int i = 0; i < kRows; ++i) {
    for (int word = 0; word < 8; ++word) {
      uint32_t bits = 0;
      std::memcpy(&bits, Seen().ptr(rng() % Seen().rows) + 4 * word, 4);
      bits ^= (rng() & 1u) << (rng() % 32) | (rng() & 1u) << (rng() % 32);
      std::memcpy(rows.ptr(i) + 4 * word, &bits, 4);
    }
  }
  return rows;
}

// The index only grows: benchmarks run in order.
PlaceDatabase& IndexOf(int keyframes) {
  static PlaceDatabase index;
  while (index.size() < keyframes) {
    index.Add(index.size(), Keyframe(index.size()));
  }
  return index;
}

void Query(benchmark::State& state) {
  const int keyframes = static_cast<int>(state.range(0));
  const PlaceDatabase& index = IndexOf(keyframes);
  constexpr int kFrames = 20;
  std::vector<cv::Mat> frames;
  for (int i = 0; i < kFrames; ++i) {
    frames.push_back(Keyframe(i * (keyframes / kFrames)));  // revisited
  }
  int found = 0;
  int asked = 0;
  for (auto _ : state) {
    const int i = asked++ % kFrames;
    const auto candidates = index.Query(frames[i], 3);
    found += !candidates.empty() &&
             candidates[0].keyframe == i * (keyframes / kFrames);
  }
  state.counters["found"] = static_cast<double>(found) / asked;
}

void Add(benchmark::State& state) {
  const int keyframes = static_cast<int>(state.range(0));
  PlaceDatabase& index = IndexOf(keyframes);
  constexpr int kNew = 20;
  std::vector<cv::Mat> added;
  for (int i = 1; i <= kNew; ++i) added.push_back(Keyframe(-i));
  int next = keyframes;
  for (auto _ : state) {
    index.Add(next, added[next % kNew]);
    ++next;
  }
  while (next > keyframes) index.Remove(--next);
}

int Register() {
  for (const int keyframes : {100, 1000, 10000}) {
    for (const auto& [name, run] :
         {std::pair("query", &Query), {"add", &Add}}) {
      benchmark::RegisterBenchmark(("places/" + std::string(name)).c_str(), run)
          ->Arg(keyframes)
          ->Iterations(200)
          ->Unit(benchmark::kMillisecond);
    }
  }
  return 0;
}
const int kRegistered = Register();

}  // namespace
}  // namespace rgbd_pose
