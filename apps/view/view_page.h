#pragma once

#include <string>

namespace rgbd_pose {

// The live page: one file that asks its server for events alone.
std::string ViewPage(const std::string& title);

}  // namespace rgbd_pose
