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

// Sets the number and the time of a frame. Frames without a timestamp are 1/30
// s apart. `last` is the previous frame, or null. Throws InputError if time
// does not increase.
void StampFrame(std::optional<double> timestamp, const TrackedFrame* last,
                Frame* frame);

// An odometry for several threads. Calls wait for each other and therefore must
// not hold the GIL. Keeps the results of all frames.
class SharedOdometry {
 public:
  SharedOdometry(const OdometrySettings& settings, const RgbdCamera& camera);

  const RgbdCamera& camera() const { return camera_; }

  // Tracks the next frame. If time does not increase (see StampFrame), throws
  // InputError and changes nothing.
  TrackedFrame Track(Frame frame, std::optional<double> timestamp,
                     const std::optional<Rigid3d>& guess);

  // The poses of the frames that were not lost.
  Trajectory trajectory();

 private:
  const RgbdCamera camera_;
  std::mutex mutex_;
  Odometry odometry_;
  std::vector<TrackedFrame> frames_;
};

// A frame for Python: the result of the odometry and the pose in the map.
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
  std::optional<MotionMatrix> covariance;  // empty if not computable
};

// A Slam for several threads, like SharedOdometry.
class SharedSlam {
 public:
  SharedSlam(const OdometrySettings& odometry, const SlamSettings& settings,
             const RgbdCamera& camera);

  const RgbdCamera& camera() const { return camera_; }

  // Throws InputError if called after the first frame, for a folder without a
  // map and for a map of another camera.
  void LoadMap(const std::string& folder, bool localise_only);

  // If time does not increase (see StampFrame) or after Finish, throws
  // InputError and changes nothing.
  FrameInMap Track(Frame frame, std::optional<double> timestamp,
                   const std::optional<Rigid3d>& guess);

  // Waits for the mapping thread. A second call has no effect.
  void Finish();

  // The current poses of the frames that were not lost.
  Trajectory trajectory();

  // These functions throw InputError before Finish.
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
