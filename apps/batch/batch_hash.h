#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "apps/batch/batch_list.h"

namespace rgbd_pose {

// A 64-bit hash of texts, the same on every platform: FNV-1a (Fowler, Noll &
// Vo). It tells runs apart that differ by accident, not by malice.
class TextHash {
 public:
  // Adds a text and that it ends here: "a" and "bc" are not "ab" and "c".
  void Add(std::string_view text);

  // 16 hexadecimal digits.
  std::string Hex() const;

 private:
  void AddByte(unsigned char byte);

  uint64_t state_ = 0xcbf29ce484222325u;
};

// A hash of all that a run reads of a sequence: rgb.txt, depth.txt, the name
// and size of each image in them, groundtruth.txt and the camera. Files that
// are missing count as such; where the sequence lies does not count.
std::string HashSequence(const BatchSequence& sequence);

// A hash of what a program does: of its file, and of the project's own shared
// libraries, if it is built with such. (Those that this process has loaded:
// programs that are installed together share them.)
std::string HashProgram(const std::string& path);

}  // namespace rgbd_pose
