#pragma once

#include <array>
#include <vector>

#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// Which keyframes of a map a camera is calibrated from, and which of them see
// the same.
struct CalibrationPairs {
  std::vector<int> in_map;                // places of keyframes in the map
  std::vector<std::array<int, 2>> pairs;  // of these keyframes, near ones first
  std::vector<bool> is_held_out;          // of each pair
};

// At most so many keyframes of the largest segment, evenly chosen, in the order
// of their times. Every n-th pair is held out, but none that two
// keyframes hang together by.
CalibrationPairs ChoosePairs(const KeyframeMap& map, int max_keyframes,
                             int hold_out);

}  // namespace rgbd_pose
