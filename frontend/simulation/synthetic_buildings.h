#pragma once

#include <cstdint>

#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {

// Scenes to walk through, for paths that return (synthetic_path.h). Walls are
// solid boxes 0.1 m thick, furniture stands along them in rows.

// A room of 9.4 x 7 m with two desks, end to end, as an island in the middle.
Scene MakeTableRoom(uint32_t seed);

// Two rooms of 5.4 x 5.4 m side by side, a door of 1.2 m between them.
Scene MakeTwoRooms(uint32_t seed);

// A corridor, 2.4 m wide and 8 m long, a hall, and the same corridor again,
// kTwinShift further along x: the same to the last texture and light.
constexpr double kTwinShift = 14.0;  // m
Scene MakeTwinCorridors(uint32_t seed);

// A depot of 42 x 22 m, rows of shelves along y and aisles between them.
constexpr int kDepotAisles = 14;
constexpr double kDepotPitch = 3.0;  // m, from aisle to aisle
Scene MakeDepot(uint32_t seed);

}  // namespace rgbd_pose
