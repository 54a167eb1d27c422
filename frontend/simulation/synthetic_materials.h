#pragma once

#include "frontend/simulation/synthetic_texture.h"

namespace rgbd_pose {

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

}  // namespace rgbd_pose
