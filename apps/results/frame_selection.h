#pragma once

#include <string>
#include <vector>

#include "frontend/sources/frame_range.h"

namespace rgbd_pose {

// Frames chosen by number on the command line: "all", or a list of numbers and
// ranges first-last or first-last:step, such as "10,20-40,100-200:10" (last
// included). The empty text chooses none.
class FrameSelection {
 public:
  // Throws InputError, naming the flag (without dashes) and its text, for any
  // other text.
  FrameSelection(const std::string& flag, const std::string& text);

  // Whether the frame with this place in its dataset (from 0) is chosen.
  bool Contains(int index) const;

 private:
  std::vector<FrameRange> ranges_;
};

}  // namespace rgbd_pose
