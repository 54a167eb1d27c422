#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"

namespace rgbd_pose {

// By the recorder: .bag files; or .db3 (sqlite3) and .mcap files, of which an
// .mcap may be of ROS 1.
enum class BagKind { kRos1, kRos2 };

// Whether a path is a bag of this kind, one that can be read or not: a file, or
// a folder of the files of one recording.
bool IsBag(const std::string& path, BagKind kind);

// Opens it. Throws InputError for what is no bag, for files that are not closed
// or packed as a whole by something else than zstd, for files of several
// recordings or cameras, and for .db3 in a build without sqlite3.
std::unique_ptr<BagReader> OpenBag(const std::string& path, BagKind kind);

}  // namespace rgbd_pose
