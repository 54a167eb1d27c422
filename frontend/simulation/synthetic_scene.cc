#include "frontend/simulation/synthetic_scene.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/simulation/synthetic_bare_scenes.h"
#include "frontend/simulation/synthetic_buildings.h"
#include "frontend/simulation/synthetic_hash.h"
#include "frontend/simulation/synthetic_room.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

struct NamedScene {
  const char* name;
  Scene (*make)(uint32_t seed);
};
constexpr NamedScene kScenes[] = {{"room", MakeRoom},
                                  {"plain_room", MakePlainRoom},
                                  {"glossy_room", MakeGlossyRoom},
                                  {"corridor", MakeCorridor},
                                  {"poster_wall", MakePosterWall},
                                  {"table", MakeTableRoom},
                                  {"two_rooms", MakeTwoRooms},
                                  {"twin_corridors", MakeTwinCorridors},
                                  {"depot", MakeDepot}};

}  // namespace

void AddBox(const SceneBox& box, bool from_within,
            const std::array<Material, 6>& materials, uint32_t seed,
            Scene* scene) {
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
    face.seed = HashCell(static_cast<int>(scene->faces.size()), 0, seed);
    scene->faces.push_back(face);
  }
}

Scene MakeScene(const std::string& name, uint32_t seed) {
  for (const NamedScene& scene : kScenes) {
    if (name == scene.name) return scene.make(seed);
  }
  throw InputError("unknown scene '" + name + "'; there are " +
                   Join(SceneNames()));
}

std::vector<std::string> SceneNames() {
  std::vector<std::string> names;
  for (const NamedScene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

}  // namespace rgbd_pose
