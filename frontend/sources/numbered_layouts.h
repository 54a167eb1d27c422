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

// A layout whose images are numbered.
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
  // specify it; null: a text file may (see NumberedCamera).
  std::optional<CameraSetup> (*camera)(const NumberedFolder& folder) = nullptr;

  const char* mark = "";  // a file that only this layout has; "": none needed

  // The preset of the camera that took all recordings of this layout: its
  // calibration is used if there is no other, its readouts if another
  // calibration states none. "": several cameras.
  const char* preset = "";
};

// Frames per second where a folder has no times.
constexpr double kNumberedRate = 30.0;

// The camera that a folder states: as its layout stores it, or a camera matrix
// in intrinsics.txt, camera-intrinsics.txt or another usual name, row by row.
// Nothing if there is none.
std::optional<CameraSetup> NumberedCamera(const NumberedLayout& layout,
                                          const NumberedFolder& folder);

// The times (s) of all colour images in timestamps.txt or times.txt, the last
// word of each line. Empty if there is no such file. Throws InputError if it
// has another number of lines, or if times do not increase.
std::vector<double> NumberedTimes(const NumberedFolder& folder);

// All layouts. A folder is opened with the first one that fits.
const std::vector<NumberedLayout>& NumberedLayouts();

}  // namespace rgbd_pose
