#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rgbd_pose {

// Decompresses data compressed by "zstd", "lz4" (frame format), "bz2" or ""
// (not at all) to `size` bytes. Throws InputError if the bytes are damaged or
// give another size, for other codecs, and in a build without these libraries.
std::string Unpack(std::string_view packed, std::string_view codec,
                   uint64_t size);

// Decompresses a message if it is compressed by zstd as a whole; uncompressed
// ROS messages begin differently. Throws as Unpack does.
std::string UnpackMessage(std::string bytes);

// Decompresses a zstd file into another file. Throws InputError as Unpack does,
// and if the output cannot be written.
void UnpackZstdFile(const std::string& packed, const std::string& unpacked);

}  // namespace rgbd_pose
