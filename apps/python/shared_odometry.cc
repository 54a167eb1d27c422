#include "apps/python/shared_odometry.h"

#include <cmath>
#include <string>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

constexpr double kDefaultFrameRate = 30.0;  // Hz

}  // namespace

void StampFrame(std::optional<double> timestamp, const TrackedFrame* last,
                Frame* frame) {
  frame->index = last == nullptr ? 0 : last->index + 1;
  frame->timestamp = timestamp.value_or(
      last == nullptr ? 0.0 : last->timestamp + 1.0 / kDefaultFrameRate);
  if (!std::isfinite(frame->timestamp)) {
    throw InputError("timestamp: is not a finite number of seconds");
  }
  if (last != nullptr && frame->timestamp <= last->timestamp) {
    throw InputError("timestamp: " + std::to_string(frame->timestamp) +
                     " s is not after that of the frame before; frames must "
                     "come in the order of time");
  }
}

SharedOdometry::SharedOdometry(const OdometrySettings& settings,
                               const RgbdCamera& camera)
    : camera_(camera), odometry_(MakeOdometry(settings, camera.camera)) {}

TrackedFrame SharedOdometry::Track(Frame frame, std::optional<double> timestamp,
                                   const std::optional<Rigid3d>& guess) {
  const std::lock_guard<std::mutex> lock(mutex_);
  StampFrame(timestamp, frames_.empty() ? nullptr : &frames_.back(), &frame);
  frames_.push_back(
      odometry_.Track(frame, guess.has_value() ? &*guess : nullptr));
  return frames_.back();
}

Trajectory SharedOdometry::trajectory() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return TrackedTrajectory(frames_);
}

}  // namespace rgbd_pose
