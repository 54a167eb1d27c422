#pragma once

#include <cstdint>

#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {

// A furnished room of 5 x 4 x 2.6 m (x, y, z) around the world's z axis.
Scene MakeRoom(uint32_t seed);

// The same with the lamp's highlights on desk, screens, floor and pictures.
Scene MakeGlossyRoom(uint32_t seed);

}  // namespace rgbd_pose
