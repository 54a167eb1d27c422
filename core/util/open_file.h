#pragma once

#include <sys/stat.h>

#include <filesystem>

namespace rgbd_pose {

// Whether an open file or folder is still the one at a path: another program
// may have removed or renamed it.
inline bool IsAt(int file, const std::filesystem::path& path) {
  struct stat open_one, one_there;
  return fstat(file, &open_one) == 0 && stat(path.c_str(), &one_there) == 0 &&
         open_one.st_dev == one_there.st_dev &&
         open_one.st_ino == one_there.st_ino;
}

}  // namespace rgbd_pose
