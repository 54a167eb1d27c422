#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frontend/files/camera_file.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// The path of a recording, and how to read it.
struct SourceOptions {
  std::string path;  // folder or file

  // A file of lines `time colour_image time depth_image`, or depth first, whose
  // pairs are used as they are. Empty: the recording specifies its pairs.
  std::string associations_file;

  // Topics of a bag: colour, depth and, if it is not next to colour, its
  // camera_info; those of sensor_msgs/Imu in any place. Those that are not
  // given are chosen by their types.
  std::vector<std::string> topics;

  // What it specifies overrides the recording. Nothing: the recording must
  // specify its camera.
  std::optional<CameraSetup> camera;

  // Raw units per metre; overrides all others. 0: from the camera, the
  // recording or, if neither specifies it, the TUM benchmark (5000).
  double depth_scale = 0.0;

  // Largest time between a colour image and its depth image, s.
  double max_time_difference = 0.02;
  bool keep_color = false;  // store colours in Frame::color

  // A file that says what is known of the inertial sensor, see
  // ReadImuCalibrationFile; overrides all others. kNoImu: its samples are not
  // read.
  std::string imu;
  static constexpr char kNoImu[] = "none";

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The camera of a recording, from the options and from the recording itself.
// Throws InputError if neither specifies a camera.
CameraSetup ChooseCamera(const SourceOptions& options,
                         const std::optional<CameraSetup>& of_recording = {});

// The kinds of recording that OpenSource accepts. The first is auto, which
// detects the kind. To add one, see docs/sources.md.
std::vector<std::string> SourceNames();

// Opens a recording. Known depth errors of its camera are corrected in its
// frames. Throws InputError for an unknown name, for a path that is no
// recording of a known kind, and if the source cannot be opened.
std::unique_ptr<FrameSource> OpenSource(const std::string& name,
                                        const SourceOptions& options);

// Opens a sequence in the layout of the TUM RGB-D benchmark, whose images are
// paired by nearest time (see Associate) or by the associations file. Throws
// InputError (file:line) for wrong columns and decreasing time stamps.
std::unique_ptr<Dataset> OpenTum(const SourceOptions& options);

}  // namespace rgbd_pose
