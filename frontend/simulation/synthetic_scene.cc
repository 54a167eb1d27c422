#include "frontend/simulation/synthetic_scene.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "core/util/named_values.h"
#include "frontend/simulation/synthetic_hash.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

const std::pair<SceneBox, const Material*> kFurniture[] = {
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

// A furnished room of 5 x 4 x 2.6 m (x, y, z) around the world's z axis.
Scene MakeRoom(uint32_t seed) {
  Scene scene = {{}, {-0.4, 0.2, 2.2}, seed};
  AddBox({{0.0, 0.0, 0.0}, {5.0, 4.0, 2.6}, 0}, true,
         {kWallpaper, kWallpaper, kWallpaper, kWallpaper, kParquet, kPlaster},
         &scene);
  for (const auto& [box, material] : kFurniture) AddBox(box, *material, &scene);
  return scene;
}

// The same room with highlights on desk, screens, floor and pictures.
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

Material Painted(const cv::Vec3f& color) { return {color, 0.0f}; }

// Low boxes near the camera, high ones along the walls, with their brightness.
const std::pair<SceneBox, float> kBoxes[] = {
    {{{0.60, 0.25, 0.0}, {0.75, 1.50, 0.74}, -18}, 0.62f},
    {{{0.74, 0.42, 0.74}, {0.20, 0.54, 0.40}, -10}, 0.70f},
    {{{0.40, -0.12, 0.74}, {0.30, 0.22, 0.16}, 25}, 0.56f},
    {{{-0.15, 0.85, 0.0}, {0.44, 0.44, 0.47}, 32}, 0.66f},
    {{{2.30, 0.60, 0.0}, {0.40, 1.40, 1.86}, 0}, 0.58f},
    {{{2.10, -1.00, 0.0}, {0.50, 0.90, 0.80}, 15}, 0.68f},
    {{{2.05, -0.90, 0.80}, {0.34, 0.36, 0.30}, 40}, 0.60f},
    {{{0.55, -1.55, 0.0}, {1.60, 0.75, 0.40}, 0}, 0.64f},
    {{{0.55, -1.86, 0.40}, {1.60, 0.20, 0.42}, 0}, 0.60f},
    {{{2.30, 1.80, 0.0}, {0.36, 0.36, 2.60}, 20}, 0.67f},
    {{{1.35, 1.60, 0.0}, {0.50, 0.45, 0.70}, 28}, 0.57f},
    {{{-0.90, 1.70, 0.0}, {0.90, 0.42, 0.75}, 0}, 0.61f},
};

// A room of the same size with a dozen boxes, each in one colour.
Scene MakePlainRoom(uint32_t seed) {
  Scene scene = {{}, {-0.4, 0.2, 2.2}, seed};
  const Material wall = Painted({0.62f, 0.64f, 0.65f});
  AddBox({{0.0, 0.0, 0.0}, {5.0, 4.0, 2.6}, 0}, true,
         {wall, wall, wall, wall, wall, wall}, &scene);
  for (const auto& [box, brightness] : kBoxes) {
    AddBox(box, Painted(cv::Vec3f::all(brightness)), &scene);
  }
  return scene;
}

// A corridor of 2 x 2.5 m, each wall in one colour.
Scene MakeCorridor(uint32_t seed) {
  // The lamp is so high that its light is the same everywhere.
  Scene scene = {{}, {-0.4, -0.35, 1000.0}, seed};
  AddBox({{0.0, -0.35, 0.0}, {40.0, 2.0, 2.5}, 0}, true,
         {Painted({0.80f, 0.82f, 0.83f}), Painted({0.80f, 0.82f, 0.83f}),
          Painted({0.90f, 0.90f, 0.88f}), Painted({0.84f, 0.88f, 0.92f}),
          Painted({0.55f, 0.58f, 0.63f}), Painted({1.00f, 1.00f, 1.00f})},
         &scene);
  return scene;
}

// One wall full of posters and nothing else.
Scene MakePosterWall(uint32_t seed) {
  Scene scene = {{}, {-0.4, 0.2, 2.2}, seed};
  AddBox({{1.0, 0.0, -5.0}, {0.2, 16.0, 14.0}, 0}, kPoster, &scene);
  return scene;
}

constexpr Named<Scene (*)(uint32_t seed)> kScenes[] = {
    {"room", MakeRoom},
    {"plain_room", MakePlainRoom},
    {"glossy_room", MakeGlossyRoom},
    {"corridor", MakeCorridor},
    {"poster_wall", MakePosterWall},
    {"table", MakeTableRoom},
    {"two_rooms", MakeTwoRooms},
    {"twin_corridors", MakeTwinCorridors}};

}  // namespace

void AddBox(const SceneBox& box, bool from_within,
            const std::array<Material, 6>& materials, Scene* scene) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(box.yaw_deg * M_PI / 180.0, Vector3d::UnitZ())
          .toRotationMatrix();
  const Vector3d middle = box.foot + Vector3d(0, 0, box.size.z() / 2);
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? -1.0 : 1.0;
    const int across = axis == 0 ? 1 : 0;
    const int down = axis == 2 ? 1 : 2;
    SceneFace face;
    face.normal = turn.col(axis) * (from_within ? -sign : sign);
    face.u_axis = turn.col(across);
    face.v_axis = turn.col(down) * (axis == 2 ? 1.0 : -1.0);
    face.width = box.size[across];
    face.height = box.size[down];
    face.origin = middle + turn.col(axis) * (sign * box.size[axis] / 2) -
                  face.u_axis * (face.width / 2) -
                  face.v_axis * (face.height / 2);
    face.material = materials[side];
    face.seed = HashCell(static_cast<int>(scene->faces.size()), 0, scene->seed);
    scene->faces.push_back(face);
  }
}

Scene MakeScene(const std::string& name, uint32_t seed) {
  return RowOf(kScenes, "scene", name).value(seed);
}

std::vector<std::string> SceneNames() { return NamesOf(kScenes); }

}  // namespace rgbd_pose
