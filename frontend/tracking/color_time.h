#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/geometry/rigid3.h"
#include "frontend/image/frame.h"
#include "frontend/tracking/keyframes.h"
#include "frontend/tracking/recent_motion.h"
#include "frontend/tracking/stamp_offset.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// Tracks frames with their depth at the time of colour (StampOffset). That
// takes the motion, which only tracking tells: first the one known before will
// do, then the frame is tracked once more with the one just found.
class ColorTime {
 public:
  // Tracks a frame; its motion since the last one, none if it is lost.
  using Track = std::function<std::optional<Rigid3d>(const PreparedFrame&)>;

  // `tracker` must outlive this. `ignore`: depth is taken as measured at the
  // time of colour, whatever its stamp says.
  ColorTime(Tracker* tracker, bool ignore)
      : tracker_(tracker),
        offset_(tracker->images().camera),
        ignores_stamps_(ignore) {}

  // The frame was made a reference with its depth as measured: that is made
  // anew as soon as a motion is known.
  void AddReference(const Frame& frame);

  // Tracks a frame against a reference, the latest one added or another.
  // `known`: its velocity as far as it is known; `interval`: since the last
  // frame, s; `once`: and not a second time. The frame as it was tracked last,
  // good until the next call; null if it is lost.
  const PreparedFrame* Follow(const PreparedFrame& measured,
                              const RecentMotion& known, double interval,
                              bool once, Keyframe* reference,
                              const Track& track);

 private:
  // Null where there is nothing to do.
  std::unique_ptr<const PreparedFrame> Undo(const PreparedFrame& measured,
                                            const RecentMotion& motion);
  // Makes the reference anew if it was made before any motion was known.
  bool MendReference(const RecentMotion& motion, Keyframe* reference);

  Tracker* tracker_;
  StampOffset offset_;
  bool ignores_stamps_;
  // The last frame, if it became the reference with a stamp offset.
  std::optional<Frame> early_reference_;
  std::unique_ptr<const PreparedFrame> moved_;  // see Follow
};

}  // namespace rgbd_pose
