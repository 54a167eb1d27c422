#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {

// Something that moves by itself: what it looks like, in axes and under a lamp
// of its own, and where it is at time t (s).
struct SyntheticMover {
  Scene scene;
  std::function<Rigid3d(double t)> world_from_mover;
};

// A printed sheet that floats 1 m before a camera on a path, wherever that
// goes, square to it and with the image's shape. It covers this share of the
// view, above 0 and at most kMaxPatchShare, and goes round an ellipse at 5 to
// 8 px a frame (of 640 x 480 at 30 Hz; image sizes scale it).
constexpr double kMaxPatchShare = 0.45;  // more would leave the image
SyntheticMover MovingPatch(double share, const Camera& camera,
                           const std::function<Rigid3d(double t)>& path,
                           uint32_t seed);

// The first so many of three printed boxes, as tall as children, that walk to
// and fro through the scene "room", at up to 0.9 m/s, and through what stands
// there.
constexpr int kMaxWalkingBoxes = 3;
std::vector<SyntheticMover> WalkingBoxes(int count, uint32_t seed);

}  // namespace rgbd_pose
