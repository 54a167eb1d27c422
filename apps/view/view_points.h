#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A point on the page: x, y, z in camera axes (mm, 16 bits each, signed, low
// byte first) and its gray level.
constexpr size_t kViewPointBytes = 7;

// Some points that a frame sees, in random order, so that the first n are a
// picture of all.
std::string SamplePoints(const Frame& frame, const Camera& camera);

}  // namespace rgbd_pose
