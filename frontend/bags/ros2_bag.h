#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"

namespace rgbd_pose {

// Whether a path is a bag of ROS 2, of a kind that can be read or not: a file
// or a folder of such.
bool IsRos2Bag(const std::string& path);

// Opens a bag of ROS 2: a .db3 (sqlite3) or .mcap file, or a folder of such; an
// .mcap file may be of ROS 1. Throws InputError for what is no bag, for files
// packed as a whole with what makes one of it, and for .db3 in a build without
// sqlite3.
std::unique_ptr<BagReader> OpenRos2Bag(const std::string& path);

}  // namespace rgbd_pose
