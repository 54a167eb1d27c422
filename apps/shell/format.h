#pragma once

#include <string>

namespace rgbd_pose {

// What printf would print.
[[gnu::format(printf, 1, 2)]] std::string Format(const char* format, ...);

}  // namespace rgbd_pose
