#pragma once

#include <string>

#include "core/geometry/camera.h"

namespace rgbd_pose {

// Where a recording is, and how to read it.
struct SourceOptions {
  std::string path;  // of its folder

  // Lines `time colour_image time depth_image`, or depth first; taken as they
  // are. Empty: the recording says itself which images belong together.
  std::string associations_file;
  RgbdCamera camera;
  // Seconds between a colour image and its depth image, at most.
  double max_time_difference = 0.02;
  bool keep_color = false;  // in Frame::color

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

}  // namespace rgbd_pose
