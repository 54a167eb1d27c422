#pragma once

#include <string>

#include "apps/export/mcap_writer.h"

namespace rgbd_pose {

// The schema of a message such as nav_msgs/Odometry, with those in it.
McapSchema Ros2Schema(const std::string& name);

}  // namespace rgbd_pose
