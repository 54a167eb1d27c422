#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rgbd_pose {

// Unpacks what a recorder has packed: by "zstd" or "lz4" (as a frame), or not
// at all (""). `size`: of what comes out. Throws InputError where that is
// something else, where the bytes are damaged, for other codecs, and in a build
// without these libraries.
std::string Unpack(std::string_view packed, std::string_view codec,
                   uint64_t size);

}  // namespace rgbd_pose
