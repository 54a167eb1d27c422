#pragma once

#include <map>
#include <string>
#include <vector>

namespace rgbd_pose {

// The files of a folder by their numbers, of the first pattern with any: a path
// below the folder with * for the number, such as color/*.jpg.
std::map<int, std::string> NumberedPaths(
    const std::string& folder, const std::vector<std::string>& choices);

}  // namespace rgbd_pose
