#include "apps/export/ros2_recording.h"

#include <filesystem>
#include <utility>

#include "apps/export/run_states.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// Frames that may wait to be written, with their images. If compressing them is
// slower than tracking for longer, tracking waits.
constexpr size_t kMaxWaiting = 8;

void RequireRosTime(double seconds) {
  if (IsRosTime(seconds)) return;
  throw InputError(
      Format("--record: ROS has times from 1970 to 2038, but a frame has the "
             "time stamp %.6f; leave out --record",
             seconds));
}

std::string McapName(const std::string& path) {
  if (std::filesystem::path(path).extension() != ".mcap") {
    throw InputError("--record=" + path +
                     ": the name of a recording for ROS 2 must end in .mcap");
  }
  return path;
}

}  // namespace

Ros2Recording::Ros2Recording(const std::string& path, const FrameSource& source)
    : path_(path),
      camera_(source.camera().camera),
      file_(McapName(path)),
      writer_("odom") {
  for (const double time : source.timestamps()) RequireRosTime(time);
}

void Ros2Recording::Add(const Frame& frame, const SequenceRun& run) {
  if (!error_.empty()) return;
  try {
    RequireRosTime(frame.timestamp);
    const std::optional<size_t> place = AddPose(run);
    WriteLast();
    last_ = frame;
    place_ = place;
    ++frames_;
    WaitForWriter(kMaxWaiting);
  } catch (const InputError& error) {
    error_ = error.what();
  }
}

std::string Ros2Recording::Finish() {
  if (!error_.empty()) throw InputError(error_);
  WriteLast();
  WaitForWriter(0);
  const Trajectory& path = states_.path();
  if (!path.empty())
    writer_.WritePath("/path", RosTime(last_->timestamp), path);
  file_.Append(writer_.Finish());
  file_.Publish();
  return Format("recorded in %s: %zu poses in the frame odom, %zu images\n",
                path_.c_str(), path.size(), frames_) +
         LeftOut(left_out_);
}

std::optional<size_t> Ros2Recording::AddPose(const SequenceRun& run) {
  const TrackedFrame& tracked = run.frames().back();
  if (tracked.status == TrackingStatus::kLost) return std::nullopt;
  int segment = tracked.segment;
  Rigid3d world_from_cam = tracked.world_from_cam;
  if (run.slam() != nullptr) {
    const SlamFrame& in_odometry = run.slam_frames().back();
    segment = in_odometry.tracked.segment;
    world_from_cam = in_odometry.odom_from_cam;
  }
  const size_t place = states_.path().size();
  if (place == 0) segment_ = segment;
  if (segment != segment_) {
    ++left_out_;
    return std::nullopt;
  }
  std::optional<RelativePose> motion;
  for (const RelativePose& edge : tracked.edges) {
    const auto ref = places_.find(edge.ref);
    if (ref == places_.end()) continue;
    motion = edge;
    motion->ref = static_cast<int>(ref->second);
    motion->cur = static_cast<int>(place);
    break;
  }
  std::optional<MotionMatrix> covariance;
  if (place == 0) covariance = MotionMatrix::Zero();  // the origin is exact
  states_.Add({RosTime(tracked.timestamp), world_from_cam}, motion, covariance);
  places_[tracked.index] = place;
  return place;
}

void Ros2Recording::WriteLast() {
  if (!last_.has_value()) return;
  std::optional<CameraState> state;
  if (place_.has_value()) state = states_.At(*place_);
  waiting_.push_back(worker_.Submit([this, state, frame = *last_] {
    if (state.has_value()) writer_.WriteState(*state);
    writer_.WriteImages(RosTime(frame.timestamp), camera_, EncodeImages(frame));
    file_.Append(writer_.Take());
  }));
}

void Ros2Recording::WaitForWriter(size_t frames) {
  while (waiting_.size() > frames) {
    std::future<void> oldest = std::move(waiting_.front());
    waiting_.pop_front();
    oldest.get();
  }
}

}  // namespace rgbd_pose
