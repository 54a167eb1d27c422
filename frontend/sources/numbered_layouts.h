#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/files/camera_setup.h"

namespace rgbd_pose {

// The poses world_from_cam of frames by their numbers; some may be missing.
using NumberedPoses = std::map<int, Rigid3d>;

// Readers of the poses of a recording in numbered files, for the table in
// numbered_layouts.cc. `numbers`: the frames of `folder`, in order. Each reader
// returns no poses if its file does not exist, and throws InputError
// (file:line) if the file holds something else.

// frame-000012.pose.txt: 4 rows of 4 numbers, one file per frame (7-Scenes).
NumberedPoses ReadFramePoses(const std::string& folder,
                             const std::vector<int>& numbers);

// pose/12.txt, the same format; -inf for a lost frame (ScanNet).
NumberedPoses ReadPoseFolder(const std::string& folder,
                             const std::vector<int>& numbers);

// traj.txt: the 16 numbers of each frame, in order, one frame per line (Replica
// as NICE-SLAM ships it).
NumberedPoses ReadPoseLines(const std::string& folder,
                            const std::vector<int>& numbers);

// trajectory.log: for each frame, in order, a line of three integers and 4 rows
// of 4 numbers (Redwood, Open3D).
NumberedPoses ReadPoseLog(const std::string& folder,
                          const std::vector<int>& numbers);

// *.gt.freiburg: TUM text in which the time is the frame's number, from 1. The
// world is mirrored (its y axis is inverted), which is undone (ICL-NUIM).
NumberedPoses ReadMirroredPoses(const std::string& folder,
                                const std::vector<int>& numbers);

// Files whose names differ by a number only: FOLDER/PREFIX123SUFFIX.
struct NumberedFiles {
  std::string folder;  // in the recording's folder; "": that folder itself
  std::string prefix;
  std::string suffix;
};

// A layout whose images are numbered and have no time stamps: one row of the
// table in numbered_layouts.cc.
struct NumberedLayout {
  const char* name;  // of the source
  const char* what;  // description for messages

  // Its images; the first alternative with any images is used.
  std::vector<NumberedFiles> color;
  std::vector<NumberedFiles> depth;

  const char* mark;    // a file that only this layout has; "": none needed
  double depth_scale;  // raw units per metre

  // Reads the camera from the folder, given the paths of a colour and a depth
  // image. Nothing if the folder does not specify it.
  std::optional<CameraSetup> (*camera)(const std::string& folder,
                                       const std::string& first_color,
                                       const std::string& first_depth);

  NumberedPoses (*poses)(const std::string& folder,
                         const std::vector<int>& numbers);
};

// Frames per second: all are from a Kinect or rendered as if.
constexpr double kNumberedRate = 30.0;

// All layouts. A folder is opened with the first one that fits.
const std::vector<NumberedLayout>& NumberedLayouts();

}  // namespace rgbd_pose
