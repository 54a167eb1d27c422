#pragma once

#include <cstdint>

#include "core/util/counter_random.h"

namespace rgbd_pose {

// Hashes instead of random generators: the value at a place (lattice cell,
// pixel, frame) depends on this place only, not on threads or on order.

// Factors of the coordinates of a lattice cell.
constexpr uint32_t kHashX = 0x9e3779b1u;
constexpr uint32_t kHashY = 0x7feb352du;

// Mixes 32 bits, or each element of a vector of 32-bit words, well. Finalizer
// of MurmurHash3 (Appleby).
template <typename Word>
[[gnu::always_inline]] inline void MixHash(Word* h) {
  *h ^= *h >> 16;
  *h *= 0x85ebca6bu;
  *h ^= *h >> 13;
  *h *= 0xc2b2ae35u;
  *h ^= *h >> 16;
}

// 32 well-mixed bits of a lattice cell.
inline uint32_t HashCell(int x, int y, uint32_t seed) {
  uint32_t h = static_cast<uint32_t>(x) * kHashX +
               static_cast<uint32_t>(y) * kHashY + seed;
  MixHash(&h);
  return h;
}

// 64 well-mixed bits of a counter.
inline uint64_t HashCounter(uint64_t counter) {
  return CounterRandom::Mix(counter * CounterRandom::kStep);
}

// A number with mean 0 and variance 1 from 64 random bits: the sum of their
// eight bytes, nearly normal (kurtosis 2.85, never beyond 4.9 sigma).
inline float GaussianFromBits(uint64_t bits) {
  constexpr uint64_t kEvenBytes = 0x00ff00ff00ff00ffu;
  uint64_t sum = (bits & kEvenBytes) + ((bits >> 8) & kEvenBytes);
  sum = (sum * 0x0001000100010001u) >> 48;
  constexpr float kMean = 8 * 127.5f;
  constexpr float kInverseSigma = 1.0f / 209.0215f;  // sqrt(8 (256^2 - 1) / 12)
  return (static_cast<float>(sum) - kMean) * kInverseSigma;
}

}  // namespace rgbd_pose
