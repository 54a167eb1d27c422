#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// How to write a sequence.
struct TumWriterOptions {
  int threads = 2;  // that read frames; the files do not depend on it
  // The true path; asked for after the last frame. Empty: that of the source.
  std::function<Trajectory()> ground_truth;
  // Told how many frames are written, one call at a time; may be empty.
  std::function<void(int done)> progress;
  // The share of frames that are left out if they cannot be read, see
  // FrameStream; nothing: each is an error.
  std::optional<double> max_damaged;
};

// What became of it.
struct WrittenSequence {
  int frames = 0;                    // written
  std::vector<std::string> damaged;  // FrameStream::damaged
  std::string stopped;               // FrameStream::stopped
};

// Writes all frames of a source in the layout of the TUM RGB-D benchmark:
// rgb/*.png (gray if the source keeps no colour) and depth/*.png named by their
// time stamps, rgb.txt, depth.txt, groundtruth.txt if there is any, and
// camera.yaml as ORB-SLAM2 reads it. Missing folders on the way to `folder`
// are made. The sequence is written to FOLDER.partial (what an earlier run left
// there is deleted) and renamed, so it is there as a whole or not at all.
// Throws InputError if `folder` holds anything already or cannot be written,
// and for a frame that cannot be read.
WrittenSequence WriteTumSequence(FrameSource* source, const std::string& folder,
                                 const TumWriterOptions& options = {});

// The text of camera.yaml: the camera, how its depth counts, and its shutters.
std::string FormatCameraYaml(const RgbdCamera& camera);

}  // namespace rgbd_pose
