#pragma once

#include <string>

#include "core/geometry/camera.h"

namespace rgbd_pose {

// The text of a camera file (ReadCameraFile) for a camera, in the layout of
// another file, whose other keys stay: of a file in ORB-SLAM's layout its lines
// and comments too. `like`: that file; a preset's name, nothing, or a file that
// cannot hold the camera gives one in ORB-SLAM's layout. What is wrong with
// depth (RgbdCamera) has keys of its own. It reads as the camera that was
// given; where other keys of `like` were lost a comment says so. Throws
// InputError as ReadCameraFile does.
std::string FormatCameraFile(const RgbdCamera& camera, const std::string& like);

}  // namespace rgbd_pose
