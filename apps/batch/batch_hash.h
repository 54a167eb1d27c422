#pragma once

#include <string>

#include "apps/batch/batch_list.h"

namespace rgbd_pose {

// A hash of all that a run reads of a sequence: rgb.txt, depth.txt, the name
// and size of each image in them, groundtruth.txt and the camera. Files that
// are missing count as such; where the sequence lies does not count.
std::string HashSequence(const BatchSequence& sequence);

// A hash of what a program does: of its file, and of the project's own shared
// libraries, if it is built with such. (Those that this process has loaded:
// programs that are installed together share them.)
std::string HashProgram(const std::string& path);

}  // namespace rgbd_pose
