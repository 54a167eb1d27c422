#pragma once

#include <cstdint>

#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {

// Scenes that lack what one or the other method lives on. All suit the paths
// of the room.

// A room of 5 x 4 x 2.6 m with a dozen boxes, all painted in one colour each:
// shapes, but no texture.
Scene MakePlainRoom(uint32_t seed);

// A corridor, 2 x 2.5 m and 40 m long, along the world's x axis, painted in one
// colour a wall: nothing tells how far along it a camera is.
Scene MakeCorridor(uint32_t seed);

// One wall full of posters and nothing else: texture, but no shape.
Scene MakePosterWall(uint32_t seed);

}  // namespace rgbd_pose
