#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"

namespace rgbd_pose {

// Whether a path is a bag of ROS 2, of a kind that can be read or not: a file
// or a folder of such.
bool IsRos2Bag(const std::string& path);

// Opens a bag of ROS 2 in sqlite3: a .db3 file, or a folder of such. Throws
// InputError for what is no bag, for other kinds (mcap, packed ones) with what
// makes one of it, and in a build without sqlite3.
std::unique_ptr<BagReader> OpenRos2Bag(const std::string& path);

}  // namespace rgbd_pose
