#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rgbd_pose {

// Decompresses data compressed by "zstd", "lz4" (frame format) or "bz2"; ""
// means uncompressed. `size` is the size of the result in bytes. Throws
// InputError if the result has another size, if the bytes are damaged, for
// other codecs, and in a build without these libraries.
std::string Unpack(std::string_view packed, std::string_view codec,
                   uint64_t size);

// Decompresses a message if it is compressed by zstd as a whole; uncompressed
// ROS messages begin differently. Throws as Unpack does.
std::string UnpackMessage(std::string bytes);

// Decompresses a zstd file into another file, piece by piece. Throws InputError
// as Unpack does, and if the output cannot be written.
void UnpackZstdFile(const std::string& packed, const std::string& unpacked);

}  // namespace rgbd_pose
