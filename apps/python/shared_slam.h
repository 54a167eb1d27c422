#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/pipeline/odometry_run.h"
#include "apps/pipeline/slam.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"
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

// A frame as Python has it: what Odometry says of it, and where the map has it.
struct FrameInMap : TrackedFrame {
  explicit FrameInMap(SlamFrame frame = {})
      : TrackedFrame(frame.tracked), slam(std::move(frame)) {}

  SlamFrame slam;
};

// A keyframe of the map without its images.
struct KeyframePose {
  int id = 0;
  int segment = 0;
  double timestamp = 0.0;
  Rigid3d map_from_cam;
  std::optional<MotionMatrix> covariance;  // if it can be computed
};

// A Slam for many threads, as SharedOdometry is an odometry.
class SharedSlam {
 public:
  SharedSlam(const OdometrySettings& odometry, const SlamSettings& settings,
             const RgbdCamera& camera);

  const RgbdCamera& camera() const { return camera_; }

  // Throws InputError after the first frame, for a folder that holds no map and
  // for a map of another camera.
  void LoadMap(const std::string& folder, bool localise_only);

  // Throws InputError, and nothing has changed, if time does not go on (see
  // StampFrame) or all is finished.
  FrameInMap Track(Frame frame, std::optional<double> timestamp,
                   const std::optional<Rigid3d>& guess);

  // Waits for the work behind; once more has no effect.
  void Finish();

  // Of the frames that were not lost, as known now.
  Trajectory trajectory();

  // They throw InputError before Finish.
  std::vector<KeyframePose> Keyframes();
  std::vector<RelativePose> Edges();
  void SaveMap(const std::string& folder);

 private:
  void RequireFinished(const char* what) const;

  const RgbdCamera camera_;
  std::mutex mutex_;
  Slam slam_;
  std::optional<TrackedFrame> last_;
  bool is_finished_ = false;
  bool is_held_ = false;
};

}  // namespace rgbd_pose
