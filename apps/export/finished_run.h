#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/pipeline/sequence.h"
#include "core/evaluation/trajectory.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/frame.h"
#include "frontend/fusion/fusion_options.h"

namespace rgbd_pose {

// A finished run of rgbd_odometry or rgbd_slam, read from its folder.
class FinishedRun {
 public:
  // Reads the poses and settings. `dataset` and `camera`, unless empty,
  // override those of the run, because the recording may have moved. Throws
  // InputError for a folder without a run or with broken files.
  explicit FinishedRun(const std::string& folder,
                       const std::string& dataset = "",
                       const std::string& camera = "");

  const std::string& folder() const { return folder_; }

  // The poses of all frames that have one, and the numbers of these frames:
  // rows of frames.csv, from 0.
  const Trajectory& trajectory() const { return trajectory_; }
  const std::vector<int>& frames() const { return frames_; }

  // The segment of each of these poses. Segments have unrelated worlds.
  const std::vector<int>& segments() const { return segments_; }

  // The number of frames without a pose.
  int lost() const { return lost_; }

  // Returns poses of the first segment, each at least `step` away from the one
  // before, as indices in trajectory().
  std::vector<int> PickViews(const MotionFilter& step) const;

  // The depth options of the run.
  const DepthLookupOptions& depth() const { return depth_; }

  // The settings that the recording was opened with.
  const SequenceSettings& sequence() const { return sequence_; }

 private:
  std::string folder_;
  SequenceSettings sequence_;
  DepthLookupOptions depth_;
  Trajectory trajectory_;
  std::vector<int> frames_;
  std::vector<int> segments_;
  int lost_ = 0;
};

// The recording of a run, for reading its frames again.
class RunRecording {
 public:
  // Opens the recording. Throws InputError if it is missing or broken. The run
  // must outlive this object.
  explicit RunRecording(const FinishedRun& run);

  const RgbdCamera& camera() const { return sequence_.source->camera(); }

  // Reads the frames of some poses (increasing indices in trajectory()) with
  // colour, in advance by `threads` threads. Call it once. Throws InputError if
  // a frame is missing or unreadable.
  using OnView = std::function<void(const Frame&, const Rigid3d&)>;
  void ReadViews(const std::vector<int>& views, int threads,
                 const OnView& on_view);

 private:
  const FinishedRun& run_;
  Sequence sequence_;
};

}  // namespace rgbd_pose
