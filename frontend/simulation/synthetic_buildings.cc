#include <cmath>
#include <utility>

#include "frontend/simulation/synthetic_hash.h"
#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHeight = 2.6;  // m, of every room
constexpr double kWall = 0.1;    // m, thickness

// A wall between two points, from `bottom` up to the ceiling (m).
void PutWall(const Vector2d& from, const Vector2d& to, double bottom,
             Scene* scene) {
  const Vector2d middle = (from + to) / 2.0;
  const Vector2d way = to - from;
  AddBox({{middle.x(), middle.y(), bottom},
          {way.norm() + kWall, kWall, kHeight - bottom},
          std::atan2(way.y(), way.x()) * 180.0 / M_PI},
         kWallpaper, scene);
}

void PutFloorAndCeiling(const Vector2d& middle, const Vector2d& size,
                        Scene* scene) {
  const Vector3d slab(size.x(), size.y(), kWall);
  AddBox({{middle.x(), middle.y(), -kWall}, slab}, kParquet, scene);
  AddBox({{middle.x(), middle.y(), kHeight}, slab}, kPlaster, scene);
}

// Places furniture by its position along a row, its distance from the wall
// behind it and its height, rotated about the vertical relative to the row.
struct Row {
  Vector2d from;
  Vector2d along;  // direction; the wall is to the right
  Scene* scene;

  // `size`: along the wall, away from it, up.
  void Put(double at, double gap, double bottom, const Vector3d& size,
           double yaw_deg, const Material& material) const {
    const Vector2d out(-along.y(), along.x());
    const Vector2d foot = from + along * at + out * (gap + size.y() / 2);
    AddBox({{foot.x(), foot.y(), bottom},
            size,
            std::atan2(along.y(), along.x()) * 180.0 / M_PI + yaw_deg},
           material, scene);
  }
};

void PutShelf(double at, double share, const Row& row) {
  const double height = 1.5 + 0.5 * share;
  row.Put(at, 0.0, 0.0, {1.06, 0.26, height}, 0.0, kBooks);
  for (int board = 1; board <= 5; ++board) {
    row.Put(at, 0.0, height * board / 5.0 - 0.03, {1.10, 0.32, 0.03}, 0.0,
            kDarkWood);
  }
  row.Put(at + 0.2 * share, 0.02, height, {0.36, 0.26, 0.25}, 20.0 * share,
          kCarton);
}

void PutChest(double at, double share, const Row& row) {
  row.Put(at, 0.02, 0.0, {0.9, 0.44, 0.6 + 0.3 * share}, 0.0, kWood);
  row.Put(at - 0.2, 0.08, 0.6 + 0.3 * share, {0.30, 0.28, 0.24}, 30.0 * share,
          kCarton);
  row.Put(at + 0.2, 0.08, 0.6 + 0.3 * share, {0.22, 0.20, 0.12}, -20.0 * share,
          kScreen);
  row.Put(at + 0.15 * share, 0.0, 1.35, {0.7, 0.015, 0.8}, 0.0, kPoster);
}

void PutCartons(double at, double share, const Row& row) {
  row.Put(at, 0.05, 0.0, {0.5, 0.42, 0.40}, 20.0 * share, kCarton);
  row.Put(at - 0.05, 0.08, 0.40, {0.34, 0.30, 0.30}, -30.0 * share, kCarton);
  row.Put(at + 0.1 * share, 0.0, 1.1, {0.9, 0.015, 0.65}, 0.0, kPoster);
}

// A row of furniture. `kind` selects the mix.
void Furnish(const Vector2d& from, const Vector2d& to, int kind, Scene* scene) {
  constexpr void (*kPieces[])(double, double, const Row&) = {PutShelf, PutChest,
                                                             PutCartons};
  constexpr double kSlot = 1.25;  // m
  const Row row = {from, (to - from).normalized(), scene};
  const int slots = static_cast<int>((to - from).norm() / kSlot);
  for (int slot = 0; slot < slots; ++slot) {
    const uint32_t chance = HashCell(slot, kind, 0);
    const double share = (chance >> 16) / 65536.0;
    kPieces[chance % 3]((slot + 0.5) * kSlot, share, row);
  }
}

// A room around the world's z axis, with furniture along its walls.
void PutFurnishedRoom(const Vector2d& size, Scene* scene) {
  PutFloorAndCeiling({0, 0}, size, scene);
  const Vector2d x(size.x() / 2, 0.0);
  const Vector2d y(0.0, size.y() / 2);
  PutWall(-x - y, x - y, 0.0, scene);
  PutWall(x - y, x + y, 0.0, scene);
  PutWall(x + y, y - x, 0.0, scene);
  PutWall(y - x, -x - y, 0.0, scene);
  constexpr double kCorner = 0.5;  // m
  const Vector2d half = size / 2.0 - Vector2d::Constant(kWall / 2.0);
  Vector2d along(1.0, 0.0);
  for (int side = 0; side < 4; ++side) {
    const Vector2d middle(along.y() * half.x(), -along.x() * half.y());
    const double reach =
        std::abs(along.x()) * half.x() + std::abs(along.y()) * half.y();
    Furnish(middle - along * (reach - kCorner),
            middle + along * (reach - kCorner), 4 + side, scene);
    along = Vector2d(-along.y(), along.x());
  }
}

// A desk with typical equipment, rotated about its middle.
void PutDesk(const Vector2d& middle, double yaw_deg, Scene* scene) {
  const std::pair<SceneBox, const Material*> pieces[] = {
      {{{0.0, 0.0, 0.71}, {1.60, 0.90, 0.03}, 0}, &kWood},
      {{{-0.74, 0.0, 0.0}, {0.04, 0.80, 0.71}, 0}, &kMetal},
      {{{0.74, 0.0, 0.0}, {0.04, 0.80, 0.71}, 0}, &kMetal},
      {{{-0.2, 0.15, 0.74}, {0.24, 0.16, 0.02}, 5}, &kMetal},
      {{{-0.2, 0.15, 0.76}, {0.54, 0.04, 0.42}, 5}, &kScreen},
      {{{-0.2, -0.22, 0.74}, {0.43, 0.15, 0.02}, -4}, &kScreen},
      {{{0.45, 0.15, 0.74}, {0.30, 0.22, 0.05}, 25}, &kBooks},
      {{{0.46, 0.16, 0.79}, {0.25, 0.18, 0.04}, -8}, &kPoster},
      {{{0.55, -0.22, 0.74}, {0.20, 0.26, 0.18}, 35}, &kCarton},
      {{{0.25, -0.25, 0.74}, {0.21, 0.30, 0.004}, 12}, &kPaper},
      {{{-0.62, -0.25, 0.74}, {0.08, 0.08, 0.10}, 30}, &kPoster},
      {{{-0.62, 0.25, 0.74}, {0.18, 0.26, 0.32}, 80}, &kBooks}};
  const double yaw = yaw_deg * M_PI / 180.0;
  for (auto [box, material] : pieces) {
    const Vector3d p = box.foot;  // in the desk's own axes
    box.foot.x() = middle.x() + std::cos(yaw) * p.x() - std::sin(yaw) * p.y();
    box.foot.y() = middle.y() + std::sin(yaw) * p.x() + std::cos(yaw) * p.y();
    box.yaw_deg += yaw_deg;
    AddBox(box, *material, scene);
  }
}

}  // namespace

Scene MakeTableRoom(uint32_t seed) {
  Scene scene = {{}, {0.3, 0.4, 2.5}, seed};
  PutFurnishedRoom({9.4, 7.0}, &scene);
  PutDesk({-0.85, 0.05}, 4.0, &scene);
  PutDesk({0.85, -0.05}, 177.0, &scene);
  return scene;
}

Scene MakeTwoRooms(uint32_t seed) {
  constexpr double kSide = 5.4;  // m
  constexpr double kDoor = 1.2;
  constexpr double kDoorHeight = 2.1;
  Scene scene = {{}, {0.0, 0.0, 4.0}, seed};  // equal light in both rooms
  PutFloorAndCeiling({0, 0}, {2 * kSide, kSide}, &scene);
  const double half = kSide / 2.0;
  PutWall({-kSide, -half}, {kSide, -half}, 0.0, &scene);
  PutWall({kSide, half}, {-kSide, half}, 0.0, &scene);
  PutWall({-kSide, half}, {-kSide, -half}, 0.0, &scene);
  PutWall({kSide, -half}, {kSide, half}, 0.0, &scene);
  PutWall({0, -half}, {0, -kDoor / 2}, 0.0, &scene);
  PutWall({0, kDoor / 2}, {0, half}, 0.0, &scene);
  PutWall({0, -kDoor / 2}, {0, kDoor / 2}, kDoorHeight, &scene);
  // Furniture along the long and the end walls; pictures next to the door.
  const double inner = half - kWall / 2.0;
  Furnish({-kSide + 0.6, -inner}, {-0.3, -inner}, 1, &scene);
  Furnish({0.3, -inner}, {kSide - 0.6, -inner}, 2, &scene);
  Furnish({kSide - 0.6, inner}, {0.3, inner}, 3, &scene);
  Furnish({-0.3, inner}, {-kSide + 0.6, inner}, 4, &scene);
  Furnish({kSide - kWall / 2, -1.8}, {kSide - kWall / 2, 2.0}, 5, &scene);
  Furnish({-kSide + kWall / 2, 1.8}, {-kSide + kWall / 2, -2.0}, 6, &scene);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.5, 1.5}) {
      AddBox({{x * (kWall / 2 + 0.01), y, 1.0}, {0.015, 0.8 + 0.1 * y, 0.9}},
             kPoster, &scene);
    }
  }
  PutDesk({-2.6, 0.0}, 80.0, &scene);
  PutDesk({2.8, 0.0}, -15.0, &scene);
  return scene;
}

Scene MakeTwinCorridors(uint32_t seed) {
  constexpr double kLength = 8.0;  // m
  constexpr double kHalfWidth = 1.2;
  constexpr double kHall = kTwinShift - kLength;
  constexpr double kHallHalf = 3.0;
  // The lamp is so high that its light is the same in both corridors.
  Scene scene = {{}, {0.0, 0.0, 1000.0}, seed};
  PutFloorAndCeiling({kLength / 2, 0}, {kLength, 2 * kHalfWidth}, &scene);
  for (const double side : {-1.0, 1.0}) {
    const double y = side * (kHalfWidth + kWall / 2);
    PutWall({0, y}, {kLength, y}, 0.0, &scene);
  }
  Furnish({kLength - 0.2, kHalfWidth}, {0.2, kHalfWidth}, 1, &scene);
  const std::vector<SceneFace> corridor = scene.faces;
  for (SceneFace face : corridor) {
    face.origin.x() += kTwinShift;
    scene.faces.push_back(face);
  }
  // The hall between the corridors, and the end walls.
  PutFloorAndCeiling({kLength + kHall / 2, 0}, {kHall, 2 * kHallHalf}, &scene);
  for (const double x : {kLength, kTwinShift}) {
    for (const double side : {-1.0, 1.0}) {
      PutWall({x, side * kHalfWidth}, {x, side * kHallHalf}, 0.0, &scene);
    }
  }
  for (const double y : {-kHallHalf, kHallHalf}) {
    PutWall({kLength, y}, {kTwinShift, y}, 0.0, &scene);
  }
  const double inner = kHallHalf - kWall / 2;
  Furnish({kLength + 0.5, -inner}, {kTwinShift - 0.2, -inner}, 2, &scene);
  Furnish({kTwinShift - 0.5, inner}, {kLength + 0.2, inner}, 3, &scene);
  for (const double x : {0.0, kTwinShift + kLength}) {
    PutWall({x, -kHalfWidth}, {x, kHalfWidth}, 0.0, &scene);
  }
  return scene;
}

}  // namespace rgbd_pose
