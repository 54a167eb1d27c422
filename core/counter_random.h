#pragma once

#include <cstdint>

namespace rgbd_pose {

// Random numbers that are the same on every platform: mixed counters
// (SplitMix64; Steele, Lea & Flood 2014).
class CounterRandom {
 public:
  explicit CounterRandom(uint64_t seed) : counter_(Mix(seed)) {}

  // 64 random bits.
  uint64_t Next() { return Mix(counter_ += 0x9e3779b97f4a7c15u); }

  // A whole number in [0, end), 0 < end < 2^32; its bias is below end / 2^32.
  uint32_t Below(uint32_t end) {
    return static_cast<uint32_t>(((Next() >> 32) * end) >> 32);
  }

 private:
  static uint64_t Mix(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }

  uint64_t counter_;
};

}  // namespace rgbd_pose
