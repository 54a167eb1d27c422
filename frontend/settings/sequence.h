#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/evaluation/truth_noise.h"
#include "frontend/frame/repeated_images.h"
#include "frontend/settings/settings.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// A sequence and its additional inputs, as users specify them; empty: none.
struct SequenceSettings {
  std::string dataset;          // path of the recording
  std::string source = "auto";  // kind of recording, see OpenSource
  std::string frames;           // range of frames, see ParseFrameRange
  std::string associations;     // file
  std::string topics;           // bag topics: COLOUR,DEPTH[,CAMERA_INFO]
  std::string camera;           // file or preset; empty: that in the recording
  std::string depth_camera;     // name in that file; empty: depth is registered
  double depth_scale = 0.0;     // raw units per metre; 0: from the recording
  std::string imu;              // file, or "none", see SourceOptions
  std::string motion_guess;     // file
  std::string groundtruth;      // file or "none"; empty: truth of the recording
  double max_damaged = 0.05;    // share of frames, see FrameStream
};

std::vector<Setting> SettingTable(SequenceSettings* settings);

// Additional inputs of a run.
struct RunInputs {
  // See MotionAlong; null: not available.
  std::shared_ptr<const Trajectory> motion_guess;
  // The share of frames that may be damaged, see FrameStream.
  double max_damaged = 0.05;
  // Of the ground truth, as far as its file or the recording tells.
  TruthNoise truth_noise = {};
  // The inertial sensor whose samples come with the frames; nothing: none.
  std::optional<ImuSensor> imu = {};
};

// An open sequence.
struct Sequence {
  std::unique_ptr<FrameSource> source;
  std::optional<Trajectory> ground_truth;  // if known before the frames
  bool compares = true;              // whether to use the recording's truth
  RunInputs inputs;                  // of a run
  std::vector<std::string> remarks;  // on the files, for users; one per line

  // The ground truth, or null if there is none. For some recordings it is known
  // only after all frames have been read. It refers to this object.
  const Trajectory* GroundTruth();
};

// Describes input that produced no frame so far, one line each, for users: the
// first damaged frames, colour images without depth, images that were sent
// twice, frames that came too fast.
std::vector<std::string> DroppedFrames(const FrameSource& source,
                                       const std::vector<std::string>& damaged,
                                       const RepeatedCounts& repeated = {});

// Opens a sequence. `keep_color`: whether to fill Frame::color. `camera`:
// overrides the camera of the settings unless null. Throws InputError for all
// errors that can be detected before images are read.
Sequence OpenSequence(const SequenceSettings& settings, bool keep_color = false,
                      const RgbdCamera* camera = nullptr);

}  // namespace rgbd_pose
