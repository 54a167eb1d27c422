#pragma once

#include <cstddef>
#include <deque>
#include <future>
#include <map>
#include <optional>
#include <string>

#include "apps/export/camera_states.h"
#include "apps/export/growing_file.h"
#include "apps/export/ros2_writer.h"
#include "core/util/worker.h"
#include "frontend/slam/sequence_run.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// A recording for ROS 2 that is written while a run tracks: the images of all
// frames, and what is known of the poses of the first segment, in the frame
// odom. With a map, poses are those of the odometry, which do not jump.
class Ros2Recording {
 public:
  // Creates the file, which must end in .mcap. Throws InputError for this and
  // for times that ROS does not have.
  Ros2Recording(const std::string& path, const FrameSource& source);

  // Call it after the run has tracked a frame, which must have its colours. If
  // writing fails, nothing more is recorded, and Finish says why.
  void Add(const Frame& frame, const SequenceRun& run);

  // Completes the file. Call it once, after the last frame. Returns the text to
  // print. Throws InputError if the file could not be written; then it is
  // removed, so that other results find space.
  std::string Finish();

 private:
  // The place of the frame's pose in the path; nothing if it has none there.
  std::optional<size_t> AddPose(const SequenceRun& run);
  // Has the last frame written, of which the velocity is known only now.
  void WriteLast();
  // Waits until at most so many frames are waiting to be written.
  void WaitForWriter(size_t frames);

  const std::string path_;
  const Camera camera_;
  CameraStates states_;
  std::map<int, size_t> places_;      // in the path, by the number of the frame
  int segment_ = 0;                   // of the path
  size_t frames_ = 0, left_out_ = 0;  // all; those of other segments
  std::optional<Frame> last_;    // the last frame, which is not written yet
  std::optional<size_t> place_;  // of its pose
  std::string error_;            // why nothing more is recorded

  // Used by the worker's tasks, and by Finish after them.
  GrowingFile file_;
  Ros2Writer writer_;

  std::deque<std::future<void>> waiting_;  // frames at the worker
  Worker worker_;                          // ends before what it uses
};

}  // namespace rgbd_pose
