#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "frontend/simulation/synthetic_texture.h"

namespace rgbd_pose {

// A rectangle of a scene, visible from the side its normal points to.
// The surface point (u, v), 0 <= u <= width, 0 <= v <= height, lies at
// origin + u * u_axis + v * v_axis. World axes, metres.
struct SceneFace {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d u_axis = Eigen::Vector3d::UnitX();  // level on upright faces
  Eigen::Vector3d v_axis = Eigen::Vector3d::UnitY();  // down on upright faces
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double width = 0.0;
  double height = 0.0;
  Material material;
  uint32_t seed = 0;  // of the texture
};

// A scene, in metres: z up, the floor at z = 0.
struct Scene {
  std::vector<SceneFace> faces;
  Eigen::Vector3d lamp = Eigen::Vector3d::Zero();  // point light
  uint32_t seed = 0;                               // of the textures to come
};

// An upright box, rotated about the vertical.
struct SceneBox {
  Eigen::Vector3d foot;  // centre of its bottom face (m)
  Eigen::Vector3d size;  // along its own axes (m)
  double yaw_deg = 0.0;
};

// Adds the faces of a box, visible from outside or, for a room, from inside.
// The materials are those of the sides -x, +x, -y, +y, -z, +z of its own axes.
void AddBox(const SceneBox& box, bool from_within,
            const std::array<Material, 6>& materials, Scene* scene);

// The same with one material, visible from outside.
inline void AddBox(const SceneBox& box, const Material& m, Scene* scene) {
  AddBox(box, false, {m, m, m, m, m, m}, scene);
}

// The scene with this name. Throws InputError that lists the names if there is
// none. `seed` changes the textures, never the geometry.
//   room         furnished and textured everywhere
//   plain_room   furnished, each piece in one colour: edges and shading only
//   glossy_room  room with highlights that move with the camera
//   corridor     40 m along x, without texture: x cannot be observed
//   poster_wall  one textured plane: texture, but no shape
// Scenes for tours, with paths of the same name (synthetic_path.h); furniture
// stands in rows along walls:
//   table           a room of 9.4 x 7 m, two desks end to end in its middle
//   two_rooms       of 5.4 x 5.4 m, with a door of 1.2 m between them
//   twin_corridors  2.4 m wide and 8 m long, a hall between them; the second is
//                   kTwinShift further along x, with the same texture and light
Scene MakeScene(const std::string& name, uint32_t seed);

// The names of all scenes.
std::vector<std::string> SceneNames();

// The scenes for tours.
constexpr double kTwinShift = 14.0;  // m
Scene MakeTableRoom(uint32_t seed);
Scene MakeTwoRooms(uint32_t seed);
Scene MakeTwinCorridors(uint32_t seed);

}  // namespace rgbd_pose
