#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frontend/files/camera_setup.h"

namespace rgbd_pose {

// Where a recording is, and how to read it.
struct SourceOptions {
  std::string path;  // of its folder or file

  // Lines `time colour_image time depth_image`, or depth first; taken as they
  // are. Empty: the recording says itself which images belong together.
  std::string associations_file;

  // Of a bag: colour, depth and, if it is not the one that belongs to colour,
  // camera_info. Empty: found by their types.
  std::vector<std::string> topics;

  // What it says comes before what the recording says; nothing: the recording
  // must say all.
  std::optional<CameraSetup> camera;

  // Raw units per metre, before all others; 0: as the camera, the recording or,
  // if they do not, the TUM benchmark says (5000).
  double depth_scale = 0.0;

  // Seconds between a colour image and its depth image, at most.
  double max_time_difference = 0.02;
  bool keep_color = false;  // in Frame::color

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// What to read a recording with, by what is asked for and what it says itself.
// Throws InputError if nobody says what camera it was.
CameraSetup ChooseCamera(const SourceOptions& options,
                         const std::optional<CameraSetup>& of_recording = {});

}  // namespace rgbd_pose
