#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

// The mask of a colour image (docs/sources.md): mask/NAME.png in its folder or
// beside that. Empty: there is none.
std::string MaskPath(const std::string& color_path);

// A line for users if there is a folder of masks and none of them belongs to
// one of the colour images of a recording; empty otherwise.
std::string MaskRemark(const std::vector<std::string>& color_paths);

}  // namespace rgbd_pose
