#include "apps/python/shared_odometry.h"

#include <cmath>
#include <string>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

constexpr double kDefaultFrameRate = 30.0;  // Hz

}  // namespace

SharedOdometry::SharedOdometry(const OdometrySettings& settings,
                               const RgbdCamera& camera)
    : camera_(camera), odometry_(MakeOdometry(settings, camera.camera)) {}

TrackedFrame SharedOdometry::Track(Frame frame, std::optional<double> timestamp,
                                   const std::optional<Rigid3d>& guess) {
  const std::lock_guard<std::mutex> lock(mutex_);
  frame.index = static_cast<int>(frames_.size());
  frame.timestamp = timestamp.value_or(NextTime());
  if (!std::isfinite(frame.timestamp) ||
      (!frames_.empty() && frame.timestamp <= frames_.back().timestamp)) {
    throw InputError("timestamp: " + std::to_string(frame.timestamp) +
                     " s is not after that of the frame before; frames must "
                     "come in the order of time");
  }
  frames_.push_back(
      odometry_.Track(frame, guess.has_value() ? &*guess : nullptr));
  return frames_.back();
}

Trajectory SharedOdometry::trajectory() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return TrackedTrajectory(frames_);
}

double SharedOdometry::NextTime() const {
  return frames_.empty() ? 0.0
                         : frames_.back().timestamp + 1.0 / kDefaultFrameRate;
}

}  // namespace rgbd_pose
