#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frontend/files/camera_setup.h"
#include "frontend/sources/numbered_poses.h"

namespace rgbd_pose {

// Files whose names differ by a number only: FOLDER/PREFIX123SUFFIX.
struct NumberedFiles {
  std::string folder;  // below the recording's; "": that one itself
  std::string prefix;
  std::string suffix;
};

// A layout whose images are numbered and have no time stamps: one row of the
// table in numbered_layouts.cc.
struct NumberedLayout {
  const char* name;  // of the source
  const char* what;  // it is, in words

  // Its images; of several alternatives the first that is there.
  std::vector<NumberedFiles> color;
  std::vector<NumberedFiles> depth;

  const char* mark;    // a file that only it has; "": none needed
  double depth_scale;  // raw units per metre
  double rate_hz;      // frames a second

  // The camera of the folder, of which paths of a colour and a depth image are
  // given. Nothing if the folder does not say.
  std::optional<CameraSetup> (*camera)(const std::string& folder,
                                       const std::string& first_color,
                                       const std::string& first_depth);

  NumberedPoses (*poses)(const std::string& folder,
                         const std::vector<int>& numbers);
};

// All of them; a folder is of the first that it fits.
const std::vector<NumberedLayout>& NumberedLayouts();

}  // namespace rgbd_pose
