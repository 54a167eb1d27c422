#pragma once

namespace rgbd_pose {

// How many processor cores this process may use, at least 1.
int AvailableCores();

}  // namespace rgbd_pose
