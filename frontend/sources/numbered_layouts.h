#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/files/camera_setup.h"

namespace rgbd_pose {

// The poses world_from_cam of frames by their numbers; some may have none.
using NumberedPoses = std::map<int, Rigid3d>;

// Readers of the poses of a recording in numbered files, for the table in
// numbered_layouts.cc: of `folder`, for the frames of these numbers, in order.
// Each gives no poses where there is no such file, and throws InputError
// (file:line) for one that holds something else.

// frame-000012.pose.txt: 4 rows of 4 numbers, a file a frame (7-Scenes).
NumberedPoses ReadFramePoses(const std::string& folder,
                             const std::vector<int>& numbers);

// pose/12.txt, the same; -inf where the frame was lost (ScanNet).
NumberedPoses ReadPoseFolder(const std::string& folder,
                             const std::vector<int>& numbers);

// traj.txt of the folder: the 16 numbers of frame after frame, one a line
// (Replica as NICE-SLAM ships it).
NumberedPoses ReadPoseLines(const std::string& folder,
                            const std::vector<int>& numbers);

// trajectory.log: for frame after frame a line of three whole numbers and 4
// rows of 4 (Redwood, Open3D).
NumberedPoses ReadPoseLog(const std::string& folder,
                          const std::vector<int>& numbers);

// *.gt.freiburg: TUM text with the number of the frame, from 1, as its time.
// The world is a mirrored one (its y axis points the other way): mirrored back
// (ICL-NUIM).
NumberedPoses ReadMirroredPoses(const std::string& folder,
                                const std::vector<int>& numbers);

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

  // The camera of the folder, of which paths of a colour and a depth image are
  // given. Nothing if the folder does not say.
  std::optional<CameraSetup> (*camera)(const std::string& folder,
                                       const std::string& first_color,
                                       const std::string& first_depth);

  NumberedPoses (*poses)(const std::string& folder,
                         const std::vector<int>& numbers);
};

// Frames a second: all are of a Kinect or rendered as if.
constexpr double kNumberedRate = 30.0;

// All of them; a folder is of the first that it fits.
const std::vector<NumberedLayout>& NumberedLayouts();

}  // namespace rgbd_pose
