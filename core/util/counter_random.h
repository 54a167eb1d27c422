#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace rgbd_pose {

// Random numbers that are the same on every platform, made by mixing the bits
// of a counter (SplitMix64; Steele, Lea & Flood 2014).
class CounterRandom {
 public:
  // The increment of the counter, and the hash of one count to 64 bits.
  static constexpr uint64_t kStep = 0x9e3779b97f4a7c15u;
  static uint64_t Mix(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }

  explicit CounterRandom(uint64_t seed) : counter_(Mix(seed)) {}

  // 64 random bits.
  uint64_t Next() { return Mix(counter_ += kStep); }

  // A whole number in [0, end), 0 < end < 2^32; its bias is below end / 2^32.
  uint32_t Below(uint32_t end) {
    return static_cast<uint32_t>(((Next() >> 32) * end) >> 32);
  }

  // Three different whole numbers below `end`, which must be at least 3.
  std::array<uint32_t, 3> ThreeBelow(uint32_t end) {
    const uint32_t a = Below(end);
    uint32_t b = Below(end - 1);
    uint32_t c = Below(end - 2);
    // Each number skips those drawn before it, in increasing order.
    if (b >= a) ++b;
    if (c >= std::min(a, b)) ++c;
    if (c >= std::max(a, b)) ++c;
    return {a, b, c};
  }

 private:
  uint64_t counter_;
};

}  // namespace rgbd_pose
