#include "frontend/simulation/synthetic_grain.h"

#include "core/util/vector_lanes.h"
#include "frontend/simulation/synthetic_hash.h"

namespace rgbd_pose {
namespace {

// Octaves of the grain, coarse to fine: cells of 0.24 m down to 2.6 mm.
constexpr int kOctaves = 8;
constexpr float kCoarsestCell = 0.24f;
constexpr float kCellRatio = 0.524f;
// Natural images lose amplitude in proportion to the wavelength; a little less
// is lost here, since corners live on the fine octaves.
constexpr float kAmplitudeRatio = 0.8f;
// Each octave is turned against the last to hide the lattice (cos, sin).
constexpr float kTurnCos = 0.8f;
constexpr float kTurnSin = 0.6f;

// All octaves of the grain at once, in the compiler's own vectors. Sums,
// products and conversions alone, so the bits are the same with every
// instruction set.
typedef float Floats __attribute__((vector_size(kOctaves * sizeof(float))));
typedef int32_t Ints __attribute__((vector_size(kOctaves * sizeof(float))));
typedef uint32_t Words __attribute__((vector_size(kOctaves * sizeof(float))));

struct OctaveTable {
  Floats cell, amplitude;
  Words number;
};

OctaveTable MakeOctaves() {
  OctaveTable table;
  float amplitude = 1.0f;
  float cell = kCoarsestCell;
  for (int octave = 0; octave < kOctaves; ++octave) {
    table.cell[octave] = cell;
    table.amplitude[octave] = amplitude;
    table.number[octave] = static_cast<uint32_t>(octave);
    amplitude *= kAmplitudeRatio;
    cell *= kCellRatio;
  }
  return table;
}

// The lowest byte of the hash of lattice cells as -1..1.
[[gnu::always_inline]] inline void Corner(const Words& cell, Floats* value) {
  Words hash = cell;
  MixHash(&hash);
  *value =
      __builtin_convertvector((Ints)(hash & 0xffu), Floats) / 127.5f - 1.0f;
}

// Value noise with cells of size 1: by place in the lattice, in -1..1.
[[gnu::always_inline]] inline void SmoothNoise(const Floats& x, const Floats& y,
                                               const Words& seed, Floats* sum) {
  Ints i = __builtin_convertvector(x, Ints);
  Ints j = __builtin_convertvector(y, Ints);
  i += x < __builtin_convertvector(i, Floats);  // down; true is -1
  j += y < __builtin_convertvector(j, Floats);
  const Floats fx = x - __builtin_convertvector(i, Floats);
  const Floats fy = y - __builtin_convertvector(j, Floats);
  const Floats wx = fx * fx * (3.0f - 2.0f * fx);
  const Floats wy = fy * fy * (3.0f - 2.0f * fy);
  const Words cell = (Words)i * kHashX + (Words)j * kHashY + seed;
  Floats a, b, c, d;
  Corner(cell, &a);
  Corner(cell + kHashX, &b);
  Corner(cell + kHashY, &c);
  Corner(cell + kHashX + kHashY, &d);
  const Floats top = a + (b - a) * wx;
  const Floats bottom = c + (d - c) * wx;
  *sum = top + (bottom - top) * wy;
}

[[gnu::always_inline]] inline float SumOfOctaves(float u, float v,
                                                 float footprint,
                                                 uint32_t seed) {
  static const OctaveTable octaves = MakeOctaves();
  Floats x, y;
  float turned_x = u;
  float turned_y = v;
  for (int octave = 0; octave < kOctaves; ++octave) {
    x[octave] = turned_x;
    y[octave] = turned_y;
    const float turned = kTurnCos * turned_x - kTurnSin * turned_y;
    turned_y = kTurnSin * turned_x + kTurnCos * turned_y;
    turned_x = turned;
  }
  Floats noise;
  SmoothNoise(x / octaves.cell, y / octaves.cell, seed + octaves.number,
              &noise);
  // Nothing of an octave is left once its shortest wavelength, two cells, is
  // under two pixels.
  Floats visible = octaves.cell / footprint - 1.0f;
  visible = visible < 0.0f ? Floats{} : visible;
  visible = visible > 1.0f ? Floats{} + 1.0f : visible;
  noise *= visible * octaves.amplitude;
  float sum = 0.0f;
  for (int octave = 0; octave < kOctaves; ++octave) sum += noise[octave];
  return sum;
}

#if defined(__x86_64__)
// Without fma, which rounds once where others round twice.
[[gnu::target("avx2")]] float SumOfOctavesAvx2(float u, float v,
                                               float footprint, uint32_t seed) {
  return SumOfOctaves(u, v, footprint, seed);
}
#endif

}  // namespace

float Grain(float u, float v, float footprint, uint32_t seed) {
#if defined(__x86_64__)
  if (packed::ChosenInstructionSet() != packed::InstructionSet::kBaseline) {
    return SumOfOctavesAvx2(u, v, footprint, seed);
  }
#endif
  return SumOfOctaves(u, v, footprint, seed);
}

}  // namespace rgbd_pose
