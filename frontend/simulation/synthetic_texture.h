#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rgbd_pose {

// The grain of a surface at (u, v) (m) for a pixel of extent `footprint` (m): a
// sum of octaves of value noise in about -3..3. The bits are the same with
// every instruction set.
float Grain(float u, float v, float footprint, uint32_t seed);

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

// Where a pixel meets a surface, in the surface's own axes (m).
struct SurfacePoint {
  float u = 0.0f;
  float v = 0.0f;
  float footprint_u = 0.0f;  // extent of the pixel along u and v
  float footprint_v = 0.0f;
};

// The colour (blue, green, red, about 0..1) of a surface, averaged over a
// pixel. Steps are box-filtered and octaves finer than the pixel fade out: a
// surface looks the same from near and far, without aliasing.
cv::Vec3f Paint(const Material& material, uint32_t seed,
                const SurfacePoint& point);

}  // namespace rgbd_pose
