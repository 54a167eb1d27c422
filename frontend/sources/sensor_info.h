#pragma once

#include <filesystem>
#include <optional>

#include "frontend/files/camera_file.h"

namespace rgbd_pose {

// The cameras and the unit of depth in info.txt (BundleFusion, and 12-Scenes,
// which has it above the folder of the images) or _info.txt (3RScan). Depth of
// another lens is assumed to be from the same place. Nothing if there is no
// such file. Throws InputError if it does not state them.
std::optional<CameraSetup> ReadSensorInfo(const std::filesystem::path& folder);

}  // namespace rgbd_pose
