#pragma once

namespace rgbd_pose {

// The largest integer that is not above x, which must fit into an int. Faster
// than std::floor, which is a function call.
inline int FloorToInt(float x) {
  const int whole = static_cast<int>(x);
  return whole - static_cast<int>(x < static_cast<float>(whole));
}

}  // namespace rgbd_pose
