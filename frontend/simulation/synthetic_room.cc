#include "frontend/simulation/synthetic_room.h"

#include "frontend/simulation/synthetic_materials.h"

namespace rgbd_pose {
namespace {

struct Furniture {
  SceneBox box;
  const Material* material;
};

const Furniture kFurniture[] = {
    // A desk and what lies on it.
    {{{0.55, 0.25, 0.71}, {0.75, 1.50, 0.03}, -18}, &kWood},
    {{{0.09, -0.29, 0.0}, {0.05, 0.05, 0.71}, -18}, &kMetal},
    {{{0.50, 0.98, 0.0}, {0.05, 0.05, 0.71}, -18}, &kMetal},
    {{{1.01, 0.80, 0.0}, {0.05, 0.05, 0.71}, -18}, &kMetal},
    {{{0.60, -0.47, 0.0}, {0.05, 0.05, 0.71}, -18}, &kMetal},
    {{{0.72, 0.42, 0.74}, {0.16, 0.24, 0.02}, -10}, &kMetal},
    {{{0.74, 0.42, 0.76}, {0.04, 0.06, 0.12}, -10}, &kMetal},
    {{{0.72, 0.42, 0.86}, {0.04, 0.54, 0.33}, -10}, &kScreen},
    {{{0.34, 0.38, 0.74}, {0.15, 0.43, 0.02}, -22}, &kScreen},
    {{{0.33, -0.12, 0.74}, {0.30, 0.22, 0.05}, 25}, &kBooks},
    {{{0.34, -0.11, 0.79}, {0.25, 0.18, 0.04}, -8}, &kPoster},
    {{{0.66, -0.16, 0.74}, {0.20, 0.26, 0.18}, 35}, &kCarton},
    {{{0.54, 0.80, 0.74}, {0.21, 0.30, 0.004}, 12}, &kPaper},
    {{{0.80, 0.84, 0.74}, {0.08, 0.08, 0.10}, 30}, &kPoster},
    // A chair in front of it.
    {{{-0.15, 0.72, 0.42}, {0.44, 0.44, 0.05}, 32}, &kFabric},
    {{{-0.15, 0.72, 0.0}, {0.10, 0.10, 0.42}, 32}, &kMetal},
    {{{-0.33, 0.61, 0.47}, {0.05, 0.42, 0.42}, 32}, &kFabric},
    // Shelves of books along the far wall.
    {{{2.37, 0.60, 0.0}, {0.22, 1.40, 1.86}, 0}, &kBooks},
    {{{2.33, 0.60, 0.36}, {0.30, 1.44, 0.03}, 0}, &kDarkWood},
    {{{2.33, 0.60, 0.72}, {0.30, 1.44, 0.03}, 0}, &kDarkWood},
    {{{2.33, 0.60, 1.08}, {0.30, 1.44, 0.03}, 0}, &kDarkWood},
    {{{2.33, 0.60, 1.44}, {0.30, 1.44, 0.03}, 0}, &kDarkWood},
    {{{2.33, 0.60, 1.83}, {0.30, 1.44, 0.03}, 0}, &kDarkWood},
    {{{2.33, -0.12, 0.0}, {0.30, 0.03, 1.86}, 0}, &kDarkWood},
    {{{2.33, 1.32, 0.0}, {0.30, 0.03, 1.86}, 0}, &kDarkWood},
    {{{2.33, 0.20, 1.86}, {0.28, 0.36, 0.26}, 14}, &kCarton},
    // A chest of drawers with cartons, a sofa, a pillar.
    {{{2.10, -1.00, 0.0}, {0.50, 0.90, 0.80}, 15}, &kWood},
    {{{2.02, -0.85, 0.80}, {0.30, 0.34, 0.28}, 40}, &kCarton},
    {{{2.15, -1.22, 0.80}, {0.22, 0.26, 0.16}, -5}, &kPoster},
    {{{0.55, -1.55, 0.0}, {1.60, 0.75, 0.40}, 0}, &kFabric},
    {{{0.55, -1.86, 0.40}, {1.60, 0.20, 0.42}, 0}, &kFabric},
    {{{-0.20, -1.52, 0.40}, {0.18, 0.75, 0.20}, 0}, &kFabric},
    {{{1.30, -1.52, 0.40}, {0.18, 0.75, 0.20}, 0}, &kFabric},
    {{{0.50, -1.60, 0.40}, {0.36, 0.12, 0.32}, 20}, &kPoster},
    {{{2.35, 1.85, 0.0}, {0.30, 0.30, 2.60}, 0}, &kWallpaper},
    {{{1.35, 1.60, 0.0}, {0.50, 0.45, 0.40}, 28}, &kCarton},
    {{{1.32, 1.58, 0.40}, {0.34, 0.30, 0.30}, -20}, &kCarton},
    {{{-0.90, 1.70, 0.0}, {0.90, 0.42, 0.75}, 0}, &kDarkWood},
    // Pictures on the walls, a rug, a lamp under the ceiling.
    {{{2.49, -0.62, 1.30}, {0.015, 0.70, 0.90}, 0}, &kPoster},
    {{{2.49, -1.48, 1.35}, {0.015, 0.50, 0.60}, 0}, &kPoster},
    {{{1.55, 1.99, 1.05}, {0.90, 0.015, 0.65}, 0}, &kPoster},
    {{{0.30, 1.99, 1.00}, {0.60, 0.015, 0.85}, 0}, &kPoster},
    {{{1.60, -1.99, 1.25}, {0.60, 0.015, 0.80}, 0}, &kPoster},
    {{{0.50, -1.99, 1.20}, {0.85, 0.015, 0.60}, 0}, &kPoster},
    {{{-2.49, 0.40, 1.10}, {0.015, 0.90, 0.65}, 0}, &kPoster},
    {{{-0.20, -0.20, 0.0}, {1.70, 1.20, 0.008}, 10}, &kFabric},
    {{{0.90, -0.30, 2.45}, {0.30, 1.10, 0.08}, 0}, &kMetal},
};

}  // namespace

Scene MakeRoom(uint32_t seed) {
  Scene scene;
  scene.lamp = {-0.4, 0.2, 2.2};
  AddBox({{0.0, 0.0, 0.0}, {5.0, 4.0, 2.6}, 0}, true,
         {kWallpaper, kWallpaper, kWallpaper, kWallpaper, kParquet, kPlaster},
         seed, &scene);
  for (const Furniture& piece : kFurniture) {
    const Material& m = *piece.material;
    AddBox(piece.box, false, {m, m, m, m, m, m}, seed, &scene);
  }
  return scene;
}

Scene MakeGlossyRoom(uint32_t seed) {
  constexpr float kGloss = 0.6f;
  Scene scene = MakeRoom(seed);
  for (SceneFace& face : scene.faces) {
    for (const Material* shiny : {&kWood, &kScreen, &kParquet, &kPoster}) {
      if (face.material.color == shiny->color) face.material.gloss = kGloss;
    }
  }
  return scene;
}

}  // namespace rgbd_pose
