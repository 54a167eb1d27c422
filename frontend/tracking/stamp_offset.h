#pragma once

#include <cmath>
#include <memory>

#include "core/geometry/camera.h"
#include "frontend/image/depth_mover.h"
#include "frontend/image/frame.h"
#include "frontend/tracking/recent_motion.h"

namespace rgbd_pose {

// Whether depth was measured at another time than colour. Below 0.1 ms not even
// a turn of 360 degrees a second moves it by half a pixel; beyond 50 ms these
// are no images of one moment, or clocks that disagree.
inline bool HasStampOffset(const Frame& frame) {
  const double offset = std::abs(frame.depth_delay);
  return offset > 1e-4 && offset < 0.05;
}

// Depth at the time of colour: what the camera moved in between is undone, to
// first order, at the velocity it had.
class StampOffset {
 public:
  // The camera of all frames.
  explicit StampOffset(const Camera& camera) : mover_(camera) {}

  // The frame with such a depth image (and no delay); null where there is
  // nothing to do or the motion is not known or too fast to be one. Its depth
  // image is good until the next call. Throws InputError for a frame that does
  // not copy itself.
  std::unique_ptr<const PreparedFrame> Undo(const PreparedFrame& frame,
                                            const RecentMotion& motion);

 private:
  DepthMover mover_;
};

}  // namespace rgbd_pose
