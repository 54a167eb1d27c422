#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_pose {

// A procedural surface: colour, grain (several octaves of noise), tiles
// (rectangles of random colour) and glyphs (words of random blocks). Lengths
// in metres, contrasts as a share of full brightness.
struct Material {
  cv::Vec3f color = {0.6f, 0.6f, 0.6f};  // blue, green, red in 0..1
  float grain = 0.2f;                    // contrast of the coarsest octave
  cv::Vec2f tile = {0.3f, 0.3f};         // width and height of a tile
  float tile_contrast = 0.0f;            // spread of their brightness
  float tile_tint = 0.0f;                // spread of their colour
  float glyph = 0.01f;                   // size of one block of a glyph
  float glyph_density = 0.0f;            // share covered by words
  float gloss = 0.0f;                    // strength of the lamp's highlight
};

// Materials of furniture and walls. The values are: colour, grain, tile size,
// tile contrast, tile tint, glyph size, glyph density.

inline const Material kPlaster = {{0.62f, 0.68f, 0.70f}, 0.16f};
inline const Material kWallpaper = {
    {0.55f, 0.60f, 0.62f}, 0.14f, {0.16f, 0.21f}, 0.05f, 0.03f, 0.016f, 0.10f};
inline const Material kParquet = {
    {0.26f, 0.38f, 0.52f}, 0.24f, {0.42f, 0.09f}, 0.10f, 0.03f};
inline const Material kWood = {{0.30f, 0.45f, 0.62f}, 0.24f};
inline const Material kDarkWood = {{0.16f, 0.24f, 0.36f}, 0.30f};
inline const Material kMetal = {{0.42f, 0.40f, 0.38f}, 0.16f};
inline const Material kFabric = {
    {0.48f, 0.32f, 0.26f}, 0.30f, {0.05f, 0.05f}, 0.08f, 0.05f};
inline const Material kCarton = {
    {0.36f, 0.52f, 0.66f}, 0.18f, {}, 0.0f, 0.0f, 0.013f, 0.25f};
inline const Material kPaper = {
    {0.85f, 0.88f, 0.88f}, 0.08f, {}, 0.0f, 0.0f, 0.006f, 0.75f};
inline const Material kPoster = {
    {0.62f, 0.58f, 0.56f}, 0.20f, {0.13f, 0.10f}, 0.22f, 0.18f, 0.011f, 0.35f};
inline const Material kBooks = {
    {0.42f, 0.42f, 0.46f}, 0.20f, {0.034f, 0.36f}, 0.22f, 0.20f, 0.008f, 0.30f};
inline const Material kScreen = {
    {0.34f, 0.28f, 0.24f}, 0.12f, {0.11f, 0.07f}, 0.12f, 0.10f, 0.006f, 0.45f};

// Where `size` pixels meet a surface, in the surface's own axes (m).
struct SurfacePoints {
  static constexpr int kMost = 32;
  using Values = std::array<float, kMost>;

  int size = 0;
  Values u = {};
  Values v = {};
  Values footprint_u = {};  // extent of a pixel along u and v
  Values footprint_v = {};
  std::array<cv::Vec3f, kMost> colors;  // made by Paint: blue, green, red
};

// The grain of a surface at each point: a sum of octaves of value noise, about
// -3..3, the same on every machine.
SurfacePoints::Values Grain(const SurfacePoints& points, uint32_t seed);

// The colours (about 0..1) of a surface, averaged over each pixel. Steps are
// box-filtered and octaves finer than the pixel fade out: a surface looks the
// same from near and far, without aliasing.
void Paint(const Material& material, uint32_t seed, SurfacePoints* points);

}  // namespace rgbd_pose
