#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// A part of a recording, by frame numbers or times: all frames or every n-th.
struct FrameRange {
  // Frame numbers, from 0; both ends are included.
  int first = 0;
  int last = std::numeric_limits<int>::max();

  // Seconds after the first frame of the recording; both ends are included.
  double begin_s = 0.0;
  double end_s = std::numeric_limits<double>::infinity();

  int step = 1;  // every n-th frame of the range, first included
};

// Parses "100-400", "100-400:2" (every second frame), "100-" (to the end) or
// "2.5s-10s" (times). The empty text means the whole recording. Throws
// InputError for any other text.
FrameRange ParseFrameRange(const std::string& text);

// That part of a source, as a source whose frames are numbered from 0. Other
// frames are not decoded. Throws InputError for a part known to have no frames.
std::unique_ptr<FrameSource> PartOf(std::unique_ptr<FrameSource> whole,
                                    const FrameRange& range);

// Frames chosen by number on the command line: "all", or a list of numbers and
// ranges such as "10,20-40,100-200:10". The empty text chooses none.
class FrameSelection {
 public:
  // Throws InputError, which names the flag, for any other text.
  FrameSelection(const std::string& flag, const std::string& text);

  // Whether the frame at this place in its dataset (from 0) is selected.
  bool Contains(int index) const;

  // The largest of the first numbers of its ranges; -1 if it is empty.
  int LastBegin() const;

 private:
  std::vector<FrameRange> ranges_;
};

}  // namespace rgbd_pose
