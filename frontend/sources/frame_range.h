#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// Part of a recording: frames by number or by time, all or every n-th.
struct FrameRange {
  // Numbers count from 0. Both ends belong to it.
  int first = 0;
  int last = std::numeric_limits<int>::max();

  // Seconds after the first frame of the recording. Both ends belong to it.
  double begin_s = 0.0;
  double end_s = std::numeric_limits<double>::infinity();

  int step = 1;  // every n-th of them, the first one included

  // Whether it is all of it.
  bool IsWhole() const;
};

// Of a text: "100-400", "100-400:2" (every second), "100-" (to the end), or
// "2.5s-10s" by time; empty: the whole recording. Throws InputError for any
// other.
FrameRange ParseFrameRange(const std::string& text);

// That part of a source, as a source whose frames are numbered from 0. Frames
// that are left out are not decoded, those after the part not even asked for.
std::unique_ptr<FrameSource> PartOf(std::unique_ptr<FrameSource> whole,
                                    const FrameRange& range);

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
