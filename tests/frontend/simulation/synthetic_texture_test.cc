// The grain of simulated surfaces: of several points together it equals that of
// points and octaves one by one.

#include "frontend/simulation/synthetic_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/util/vector_lanes.h"
#include "frontend/simulation/synthetic_hash.h"

namespace rgbd_pose {
namespace {

float Corner(int i, int j, uint32_t seed) {
  return static_cast<float>(HashCell(i, j, seed) & 0xffu) / 127.5f - 1.0f;
}

float OneOctave(float x, float y, uint32_t seed) {
  const float i = std::floor(x), j = std::floor(y);
  const float fx = x - i, fy = y - j;
  const float wx = fx * fx * (3.0f - 2.0f * fx);
  const float wy = fy * fy * (3.0f - 2.0f * fy);
  const int left = static_cast<int>(i), up = static_cast<int>(j);
  const float a = Corner(left, up, seed), b = Corner(left + 1, up, seed);
  const float c = Corner(left, up + 1, seed);
  const float d = Corner(left + 1, up + 1, seed);
  const float top = a + (b - a) * wx, bottom = c + (d - c) * wx;
  return top + (bottom - top) * wy;
}

float OctaveByOctave(float x, float y, float footprint, uint32_t seed) {
  float sum = 0.0f, amplitude = 1.0f, cell = 0.24f;
  for (uint32_t octave = 0; octave < 8; ++octave) {
    const float visible = std::clamp(cell / footprint - 1.0f, 0.0f, 1.0f);
    sum += visible * amplitude * OneOctave(x / cell, y / cell, seed + octave);
    amplitude *= 0.8f;
    cell *= 0.524f;
    const float turned = 0.8f * x - 0.6f * y;
    y = 0.6f * x + 0.8f * y;
    x = turned;
  }
  return sum;
}

void ExpectOctaves() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-20.0f, 20.0f);
  std::uniform_real_distribution<float> exponent(-4.0f, 0.0f);
  for (uint32_t seed = 0; seed < 100; ++seed) {
    SurfacePoints points;
    points.size = 1 + static_cast<int>(seed) % SurfacePoints::kMost;
    for (int k = 0; k < points.size; ++k) {
      points.u[k] = place(random);
      points.v[k] = place(random);
      points.footprint_u[k] = std::pow(10.0f, exponent(random));
      points.footprint_v[k] = std::pow(10.0f, exponent(random));
    }
    const SurfacePoints::Values grain = Grain(points, seed);
    for (int k = 0; k < points.size; ++k) {
      const float u = points.u[k], v = points.v[k];
      const float footprint =
          std::max(points.footprint_u[k], points.footprint_v[k]);
      EXPECT_EQ(grain[k], OctaveByOctave(u, v, footprint, seed))
          << u << " " << v << " " << footprint;
    }
  }
}

TEST(SyntheticGrainTest, IsTheSumOfItsOctaves) { ExpectOctaves(); }

#if defined(__x86_64__)
TEST(SyntheticGrainTest, IsTheSameOnEveryMachine) {
  packed::InstructionSet& chosen = packed::ChosenInstructionSet();
  const packed::InstructionSet before = chosen;
  chosen = packed::InstructionSet::kBaseline;
  ExpectOctaves();
  chosen = before;
}
#endif

}  // namespace
}  // namespace rgbd_pose
