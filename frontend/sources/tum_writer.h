#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/evaluation/truth_noise.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// How to write a sequence.
struct TumWriterOptions {
  int threads = 2;  // that read frames; no effect on the files
  // Returns the true path; called after the last frame. Empty: the source's.
  std::function<Trajectory()> ground_truth;
  TruthNoise truth_noise = {};  // of that path, for readers of the sequence
  // Called with the number of written frames, from one thread; may be empty.
  std::function<void(int done)> progress;
  // Asked after each frame: why to stop with the frames so far, such as the
  // name of a signal; an empty text or function: goes on.
  std::function<std::string()> stop;
  // The share of unreadable frames that may be left out, see FrameStream;
  // nothing: every unreadable frame is an error.
  std::optional<double> max_damaged;
};

// The result of writing a sequence.
struct WrittenSequence {
  int frames = 0;                    // written
  int imu_samples = 0;               // written
  std::vector<std::string> damaged;  // FrameStream::damaged
  std::string stopped;               // why it ended early; empty: it did not
  std::string remark;                // what readers have to know; may be empty
};

// Writes all frames of a source in the layout of the TUM RGB-D benchmark (grey
// if the source keeps no colour), with groundtruth.txt if there is a true path,
// with imu.csv and imu.yaml if there is an inertial sensor, and camera.yaml in
// ORB-SLAM2's format. The sequence exists as a whole or not at all: it is
// written to FOLDER.rgbd_convert.partial, which is renamed at the end. There it
// can be read after each frame, so a camera's recording outlives a killed
// program, and is not overwritten. Throws InputError if `folder` is a file, is
// not empty or cannot be written, if a killed program left such a recording,
// and for an unreadable frame.
WrittenSequence WriteTumSequence(FrameSource* source, const std::string& folder,
                                 const TumWriterOptions& options = {});

}  // namespace rgbd_pose
