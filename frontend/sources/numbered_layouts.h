#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/files/camera_file.h"

namespace rgbd_pose {

// A frame of a recording in numbered files.
struct NumberedFrame {
  int number = 0;
  std::string color_path;
  std::string depth_path;
};

struct NumberedFolder {
  std::filesystem::path path;
  std::vector<NumberedFrame> frames;  // by number
  std::vector<int> numbers;           // of all colour images, in order
};

// The poses world_from_cam of images by their numbers: some, or too many.
using NumberedPoses = std::map<int, Rigid3d>;

// A layout whose images are numbered and have no time stamps.
struct NumberedLayout {
  const char* name;  // of the source
  const char* what;  // description for messages

  // Its images, with * for the number, by the first alternative with any.
  std::vector<std::string> color;
  std::vector<std::string> depth;

  double depth_scale;  // raw units per metre

  // Reads the true poses. None if their file does not exist. Throws InputError
  // (file:line) if it holds something else.
  NumberedPoses (*poses)(const NumberedFolder& folder);

  // Reads the camera, given at least one frame. Nothing if the folder does not
  // specify it; null: none of this layout does.
  std::optional<CameraSetup> (*camera)(const NumberedFolder& folder) = nullptr;

  const char* mark = "";  // a file that only this layout has; "": none needed
};

// Frames per second: all are from a Kinect or rendered as if.
constexpr double kNumberedRate = 30.0;

// All layouts. A folder is opened with the first one that fits.
const std::vector<NumberedLayout>& NumberedLayouts();

}  // namespace rgbd_pose
