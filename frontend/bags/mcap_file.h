#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"

namespace rgbd_pose {

// Opens an mcap file with messages of ROS 2 (cdr) or ROS 1: channels of other
// encodings are left out. Throws InputError for what is no such file.
std::unique_ptr<BagReader> OpenMcapFile(const std::string& path);

}  // namespace rgbd_pose
