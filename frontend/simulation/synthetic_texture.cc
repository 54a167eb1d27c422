#include "frontend/simulation/synthetic_texture.h"

#include <algorithm>
#include <cstring>

#include "core/util/vector_lanes.h"
#include "frontend/simulation/synthetic_hash.h"

namespace rgbd_pose {
namespace {

// Octaves of the grain, coarse to fine: cells of 0.24 m down to 2.6 mm.
constexpr int kOctaves = 8;
constexpr float kCoarsestCell = 0.24f;
constexpr float kCellRatio = 0.524f;
// In natural images the amplitude is proportional to the wavelength. Here it
// decreases less, since corners come from the fine octaves.
constexpr float kAmplitudeRatio = 0.8f;
// Each octave is rotated relative to the last to hide the lattice (cos, sin).
constexpr float kTurnCos = 0.8f;
constexpr float kTurnSin = 0.6f;

// Several pixels at once, in the compiler's own vectors. With basic arithmetic
// alone, the bits are the same with every instruction set.
constexpr int kLanes = 8;
static_assert(SurfacePoints::kMost % kLanes == 0, "no vector reads beyond");
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef int32_t Ints __attribute__((vector_size(kLanes * sizeof(float))));
typedef uint32_t Words __attribute__((vector_size(kLanes * sizeof(float))));

// The lowest byte of the hash of each lattice cell, as -1..1.
[[gnu::always_inline]] inline void Corner(const Words& cell, Floats* value) {
  Words hash = cell;
  MixHash(&hash);
  *value =
      __builtin_convertvector((Ints)(hash & 0xffu), Floats) / 127.5f - 1.0f;
}

// Value noise in -1..1 at places in a lattice with cells of size 1.
[[gnu::always_inline]] inline void SmoothNoise(const Floats& x, const Floats& y,
                                               uint32_t seed, Floats* noise) {
  Ints i = __builtin_convertvector(x, Ints);
  Ints j = __builtin_convertvector(y, Ints);
  i += x < __builtin_convertvector(i, Floats);  // rounds down; true is -1
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
  *noise = top + (bottom - top) * wy;
}

[[gnu::always_inline]] inline SurfacePoints::Values SumOfOctaves(
    const SurfacePoints& p, uint32_t seed) {
  SurfacePoints::Values sums = {};
  for (int k = 0; k < p.size; k += kLanes) {
    Floats x, y, width, height, sum = {};
    std::memcpy(&x, &p.u[k], sizeof(x));
    std::memcpy(&y, &p.v[k], sizeof(y));
    std::memcpy(&width, &p.footprint_u[k], sizeof(width));
    std::memcpy(&height, &p.footprint_v[k], sizeof(height));
    const Floats footprint = width < height ? height : width;
    float amplitude = 1.0f, cell = kCoarsestCell;
    for (uint32_t octave = 0; octave < kOctaves; ++octave) {
      // An octave vanishes when its cells are smaller than pixels.
      Floats visible = cell / footprint - 1.0f;
      visible = visible < 0.0f ? Floats{} : visible;
      visible = visible > 1.0f ? Floats{} + 1.0f : visible;
      Floats noise;
      SmoothNoise(x / cell, y / cell, seed + octave, &noise);
      sum += visible * amplitude * noise;
      amplitude *= kAmplitudeRatio;
      cell *= kCellRatio;
      const Floats turned = kTurnCos * x - kTurnSin * y;
      y = kTurnSin * x + kTurnCos * y;
      x = turned;
    }
    std::memcpy(&sums[k], &sum, sizeof(sum));
  }
  return sums;
}

#if defined(__x86_64__)
// Without FMA, which rounds once instead of twice.
[[gnu::target("avx2")]] SurfacePoints::Values SumOfOctavesAvx2(
    const SurfacePoints& points, uint32_t seed) {
  return SumOfOctaves(points, seed);
}
#endif

// A word is a row of glyphs; there are gaps between lines of words.
constexpr float kWordLength = 11.0f;  // in blocks
constexpr float kLineHeight = 5.0f;
constexpr float kGlyphHeight = 3.0f;

float Clamp01(float x) { return std::min(std::max(x, 0.0f), 1.0f); }

float Signed(uint32_t hash, int byte) {  // -1 to 1
  return static_cast<float>((hash >> (8 * byte)) & 0xffu) / 127.5f - 1.0f;
}

// Calls use(hash, weight) for each cell, of size 1, under a pixel of extent
// (footprint_x, footprint_y): one within a cell, up to four at its corners.
template <typename Use>
void ForCellsUnderPixel(float x, float y, float footprint_x, float footprint_y,
                        uint32_t seed, Use use) {
  const int i = cvFloor(x - 0.5f);
  const int j = cvFloor(y - 0.5f);
  const float wx =
      Clamp01((x - 1.0f - static_cast<float>(i)) / footprint_x + 0.5f);
  const float wy =
      Clamp01((y - 1.0f - static_cast<float>(j)) / footprint_y + 0.5f);
  for (int corner = 0; corner < 4; ++corner) {
    const int right = corner & 1;
    const int below = corner >> 1;
    const float weight = (right ? wx : 1.0f - wx) * (below ? wy : 1.0f - wy);
    if (weight > 0.0f) use(HashCell(i + right, j + below, seed), weight);
  }
}

cv::Vec3f Tiles(const Material& material, const SurfacePoints& p, int k,
                uint32_t seed) {
  cv::Vec3f shift(0, 0, 0);
  ForCellsUnderPixel(
      p.u[k] / material.tile[0], p.v[k] / material.tile[1],
      p.footprint_u[k] / material.tile[0], p.footprint_v[k] / material.tile[1],
      seed, [&](uint32_t hash, float weight) {
        const float gray = material.tile_contrast * Signed(hash, 3);
        for (int c = 0; c < 3; ++c) {
          shift[c] += weight * (gray + material.tile_tint * Signed(hash, c));
        }
      });
  return shift;
}

// The share of the pixel that is covered by ink of words, 0..1.
float Ink(const Material& material, const SurfacePoints& p, int k,
          uint32_t seed) {
  const float block = material.glyph;
  // 0 when the shortest wavelength, two blocks, is below two pixels.
  const float visible =
      Clamp01(block / std::max(p.footprint_u[k], p.footprint_v[k]) - 1.0f);
  const float x = p.u[k] / block;
  const float y = p.v[k] / block;
  const float width = p.footprint_u[k] / block;
  const float height = p.footprint_v[k] / block;
  float word = 0.0f;
  ForCellsUnderPixel(x / kWordLength, y / kLineHeight, width / kWordLength,
                     height / kLineHeight, seed,
                     [&](uint32_t hash, float weight) {
                       const float share = (hash & 0xffffu) / 65536.0f;
                       if (share < material.glyph_density) word += weight;
                     });
  if (word == 0.0f) return 0.0f;
  const float line =
      y - kLineHeight * static_cast<float>(cvFloor(y / kLineHeight));
  word *= Clamp01(line / height) * Clamp01((kGlyphHeight - line) / height);
  float bit = 0.0f;
  ForCellsUnderPixel(x, y, width, height, seed + 1,
                     [&](uint32_t hash, float weight) {
                       bit += weight * static_cast<float>(hash & 1u);
                     });
  return word * (0.5f + visible * (bit - 0.5f));
}

}  // namespace

SurfacePoints::Values Grain(const SurfacePoints& points, uint32_t seed) {
#if defined(__x86_64__)
  if (packed::ChosenInstructionSet() != packed::InstructionSet::kBaseline) {
    return SumOfOctavesAvx2(points, seed);
  }
#endif
  return SumOfOctaves(points, seed);
}

void Paint(const Material& material, uint32_t seed, SurfacePoints* points) {
  SurfacePoints::Values grain = {};
  if (material.grain != 0.0f) grain = Grain(*points, seed);
  for (int k = 0; k < points->size; ++k) {
    cv::Vec3f& color = points->colors[k] = material.color;
    if (material.tile_contrast > 0.0f || material.tile_tint > 0.0f) {
      color += Tiles(material, *points, k, seed + 0x100u);
    }
    color *= 1.0f + material.grain * grain[k];
    if (material.glyph_density > 0.0f) {
      const float paper = 1.0f - Ink(material, *points, k, seed + 0x200u);
      color *= 0.15f + 0.85f * paper;
    }
  }
}

}  // namespace rgbd_pose
