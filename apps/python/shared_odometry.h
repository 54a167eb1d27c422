#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include "apps/pipeline/odometry_run.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"
#include "frontend/tracking/odometry.h"
#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

// Numbers a frame and says when it was taken: without a time stamp, frames come
// at 30 Hz. `last`: the one before, or null. Throws InputError if time does not
// go on.
void StampFrame(std::optional<double> timestamp, const TrackedFrame* last,
                Frame* frame);

// An odometry for many threads: calls wait for each other, so they must not
// hold the GIL. Remembers what became of all frames.
class SharedOdometry {
 public:
  SharedOdometry(const OdometrySettings& settings, const RgbdCamera& camera);

  const RgbdCamera& camera() const { return camera_; }

  // Tracks the next frame. Throws InputError, and nothing has changed, if time
  // does not go on (see StampFrame).
  TrackedFrame Track(Frame frame, std::optional<double> timestamp,
                     const std::optional<Rigid3d>& guess);

  // Of the frames that were not lost.
  Trajectory trajectory();

 private:
  const RgbdCamera camera_;
  std::mutex mutex_;
  Odometry odometry_;
  std::vector<TrackedFrame> frames_;
};

}  // namespace rgbd_pose
