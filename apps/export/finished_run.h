#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/pipeline/sequence.h"
#include "core/evaluation/trajectory.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/frame.h"
#include "frontend/fusion/fusion_options.h"

namespace rgbd_pose {

// A finished run of rgbd_odometry or rgbd_slam, read from its folder.
struct FinishedRun {
  // Reads the poses and settings. `dataset` and `camera`, unless empty,
  // override those of the run, because the recording may have moved. Throws
  // InputError for a folder without a run or with broken files.
  explicit FinishedRun(const std::string& run_folder,
                       const std::string& dataset = "",
                       const std::string& camera = "");

  std::string folder;         // of its results
  SequenceSettings sequence;  // with which the recording was opened
  DepthLookupOptions depth;   // of the run

  // The poses of all frames that have one. Of each pose: the number of its
  // frame (row of frames.csv, from 0) and its segment. Segments have unrelated
  // worlds.
  Trajectory trajectory;
  std::vector<int> frames;
  std::vector<int> segments;

  int lost = 0;  // number of frames without a pose
};

// Opens the recording of a run to read its frames again, with colour. Throws
// InputError if it is missing or broken.
std::unique_ptr<FrameSource> OpenRecording(const FinishedRun& run);

// Called for a frame of a run; `view` is the index of its pose.
using OnView = std::function<void(const Frame& frame, int view)>;

// Reads frames of the first segment, each at least `step` away from the one
// before, in advance by `threads` threads. Call it once for an opened
// recording. Returns the indices of their poses in the trajectory. Throws
// InputError if a frame is missing or unreadable.
std::vector<int> ReadViews(const FinishedRun& run, const MotionFilter& step,
                           int threads, FrameSource* source,
                           const OnView& on_view);

}  // namespace rgbd_pose
