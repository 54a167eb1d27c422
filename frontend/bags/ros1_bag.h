#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"

namespace rgbd_pose {

// Opens a bag of ROS 1 (also what the RealSense viewer records), packed or not.
// Throws InputError for what is no bag, for one that was not closed, and in a
// build without librosbag-storage.
std::unique_ptr<BagReader> OpenRos1Bag(const std::string& path);

}  // namespace rgbd_pose
