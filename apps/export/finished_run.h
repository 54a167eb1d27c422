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

// A run of rgbd_odometry or rgbd_slam that has ended, from the files in its
// folder.
class FinishedRun {
 public:
  // Reads the poses and the settings. `dataset` and `camera` take the place of
  // the run's, unless empty: the recording may have moved. Throws InputError
  // for a folder without a run or files that are broken.
  explicit FinishedRun(const std::string& folder,
                       const std::string& dataset = "",
                       const std::string& camera = "");

  // Where it is.
  const std::string& folder() const { return folder_; }

  // The poses of all frames that have one, and which frames these are: rows of
  // frames.csv, from 0.
  const Trajectory& trajectory() const { return trajectory_; }
  const std::vector<int>& frames() const { return frames_; }

  // Which segment each of these poses is of: how segments lie to each other is
  // unknown.
  const std::vector<int>& segments() const { return segments_; }

  // How many frames have no pose.
  int lost() const { return lost_; }

  // Poses of the first segment, each so far from the one before: numbers in
  // trajectory().
  std::vector<int> PickViews(const MotionFilter& step) const;

  // Which depths were used.
  const DepthLookupOptions& depth() const { return depth_; }

  // What the recording was opened by.
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

// The recording of a run, to read frames of it again.
class RunRecording {
 public:
  // Opens it. Throws InputError if it is gone or broken. The run must outlive
  // it.
  explicit RunRecording(const FinishedRun& run);

  // That took it.
  const RgbdCamera& camera() const { return sequence_.source->camera(); }

  // Reads the frames of some poses, numbers in trajectory() that increase, with
  // colour, by `threads` threads ahead; once. Throws InputError if one of these
  // frames is gone or unreadable.
  using OnView = std::function<void(const Frame&, const Rigid3d&)>;
  void ReadViews(const std::vector<int>& views, int threads,
                 const OnView& on_view);

 private:
  const FinishedRun& run_;
  Sequence sequence_;
};

}  // namespace rgbd_pose
