#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <list>
#include <vector>

#include "costs/assembly/packed_sum.h"

namespace rgbd_pose {

// The points that a direct cost has selected in its latest previous frames. A
// level is selected when it is needed for the first time.
class SelectedPoints {
 public:
  explicit SelectedPoints(int num_levels) : num_levels_(num_levels) {}

  // Continues with the frame that has this FrameView::id. Nothing is known of
  // frames with id 0.
  void Begin(uint64_t id) {
    const auto known =
        std::find_if(frames_.begin(), frames_.end(),
                     [=](const Points& frame) { return frame.id == id; });
    if (known != frames_.end()) {
      frames_.splice(frames_.begin(), frames_, known);
      if (id != 0) return;
    } else if (frames_.size() < kMaxFrames) {
      frames_.emplace_front();
      frames_.front().levels.resize(num_levels_);
    } else {
      frames_.splice(frames_.begin(), frames_, std::prev(frames_.end()));
    }
    frames_.front().id = id;
    for (Level& level : frames_.front().levels) level.is_selected = false;
  }

  // The points of the frame at a level; `select(columns)` fills them.
  template <typename Select>
  const PackedColumns& At(int level, const Select& select) {
    Level& points = frames_.front().levels[level];
    if (!points.is_selected) {
      select(&points.columns);
      points.is_selected = true;
    }
    return points.columns;
  }

 private:
  // Keyframes that are compared in turn, at about 0.3 MB each.
  static constexpr size_t kMaxFrames = 24;

  struct Level {
    PackedColumns columns;
    bool is_selected = false;
  };
  struct Points {
    uint64_t id = 0;
    std::vector<Level> levels;
  };

  int num_levels_;
  std::list<Points> frames_;  // the latest first
};

}  // namespace rgbd_pose
