#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"

namespace rgbd_pose {

// Opens a bag of ROS 1 (also what the RealSense viewer records), packed or not:
// each of its chunks is unpacked once, also where their times overlap. Throws
// InputError for what is no bag and for one that was not closed.
std::unique_ptr<BagReader> OpenRos1Bag(const std::string& path);

}  // namespace rgbd_pose
