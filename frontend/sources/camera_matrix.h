#pragma once

#include <string>

#include "core/geometry/camera.h"

namespace rgbd_pose {

// Reads a 3 x 3 or 4 x 4 camera matrix, row by row, from a text file; takes the
// image size from an image. Throws InputError if there is no sound camera.
Camera ReadCameraMatrix(const std::string& path, const std::string& image_path);

}  // namespace rgbd_pose
