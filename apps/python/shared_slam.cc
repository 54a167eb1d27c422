#include "apps/python/shared_slam.h"

#include <cmath>
#include <string>

#include "core/util/input_error.h"
#include "frontend/map/map_folder.h"

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
                     " s is not after that of the previous frame; frames must "
                     "be in the order of time");
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

SharedSlam::SharedSlam(const OdometrySettings& odometry,
                       const SlamSettings& settings, const RgbdCamera& camera)
    : camera_(camera), slam_(odometry, settings, camera.camera) {}

void SharedSlam::LoadMap(const std::string& folder, bool localise_only) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (last_.has_value() || is_finished_) {
    throw InputError("load_map: maps must be loaded before the first frame");
  }
  slam_.Load(rgbd_pose::LoadMap(folder), localise_only);
  is_held_ = is_held_ || localise_only;
}

FrameInMap SharedSlam::Track(Frame frame, std::optional<double> timestamp,
                             const std::optional<Rigid3d>& guess) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (is_finished_) {
    throw InputError(
        "track: finish() was called; save the map and load it in "
        "another Slam to continue");
  }
  StampFrame(timestamp, last_.has_value() ? &*last_ : nullptr, &frame);
  FrameInMap result(slam_.Track(frame, guess.has_value() ? &*guess : nullptr));
  last_ = result;
  return result;
}

void SharedSlam::Finish() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!is_finished_) slam_.Finish();
  is_finished_ = true;
}

Trajectory SharedSlam::trajectory() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return slam_.Path();
}

std::vector<KeyframePose> SharedSlam::Keyframes() {
  const std::lock_guard<std::mutex> lock(mutex_);
  RequireFinished("keyframes");
  const std::vector<MotionMatrix> covariances = slam_.Covariances();
  std::vector<KeyframePose> poses;
  for (const Keyframe& keyframe : slam_.Map().keyframes) {
    KeyframePose pose;
    pose.id = keyframe.id;
    pose.segment = keyframe.segment;
    pose.timestamp = keyframe.images.timestamp;
    pose.map_from_cam = keyframe.world_from_cam;
    if (!covariances.empty()) pose.covariance = covariances[poses.size()];
    poses.push_back(pose);
  }
  return poses;
}

std::vector<RelativePose> SharedSlam::Edges() {
  const std::lock_guard<std::mutex> lock(mutex_);
  RequireFinished("edges");
  return slam_.Map().edges;
}

void SharedSlam::SaveMap(const std::string& folder) {
  const std::lock_guard<std::mutex> lock(mutex_);
  RequireFinished("save_map");
  if (is_held_) {
    throw InputError(
        "save_map: localise_only does not change the map, so there is nothing "
        "to save");
  }
  rgbd_pose::SaveMap(folder, slam_.Map());
}

void SharedSlam::RequireFinished(const char* what) const {
  if (is_finished_) return;
  throw InputError(std::string(what) + ": finish() must be called first");
}

}  // namespace rgbd_pose
