#pragma once

#include <string>

namespace rgbd_pose {

// Bytes as text (RFC 4648).
std::string Base64(const std::string& bytes);

}  // namespace rgbd_pose
