#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rgbd_pose {

// Unpacks what a recorder has packed: by "zstd", "lz4" (as a frame) or "bz2",
// or not at all (""). `size`: of what comes out. Throws InputError where that
// is something else, where the bytes are damaged, for other codecs, and in a
// build without these libraries.
std::string Unpack(std::string_view packed, std::string_view codec,
                   uint64_t size);

// Whether bytes are those of zstd, as a whole file or message is packed: a
// message of ROS, a database or an mcap file begins otherwise.
bool IsZstd(std::string_view bytes);

// A message that is packed by zstd as a whole; as Unpack.
std::string UnpackZstdMessage(std::string_view packed);

// Writes what a file packed by zstd holds into another, piece by piece. Throws
// InputError as Unpack does, and where it cannot be written.
void UnpackZstdFile(const std::string& packed, const std::string& unpacked);

}  // namespace rgbd_pose
