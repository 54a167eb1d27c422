#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"

namespace rgbd_pose {

// Opens one file of a ROS 2 bag in sqlite3. Throws InputError if it is not one,
// and in a build without sqlite3.
std::unique_ptr<BagReader> OpenBagDatabase(const std::string& path);

}  // namespace rgbd_pose
