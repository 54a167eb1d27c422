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

// Whether bytes are zstd data, as of a file or message compressed as a whole.
// Uncompressed ROS messages, databases and mcap files begin differently.
bool IsZstd(std::string_view bytes);

// Decompresses a message compressed by zstd as a whole. Throws as Unpack does.
std::string UnpackZstdMessage(std::string_view packed);

// Decompresses a zstd file into another file, piece by piece. Throws InputError
// as Unpack does, and if the output cannot be written.
void UnpackZstdFile(const std::string& packed, const std::string& unpacked);

}  // namespace rgbd_pose
