#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/odometry_run.h"
#include "apps/pipeline/settings.h"
#include "core/evaluation/trajectory.h"
#include "frontend/sources/frame_source.h"
#include "frontend/tracking/motion_guess.h"

namespace rgbd_pose {

// A sequence and what is known of it, as users say it; empty: none.
struct SequenceSettings {
  std::string dataset;          // path of a recording
  std::string source = "auto";  // its kind, see OpenSource
  std::string frames;           // part of it, see ParseFrameRange
  std::string associations;     // file
  std::string topics;           // of a bag: COLOUR,DEPTH[,CAMERA_INFO]
  std::string camera;           // file or preset; empty: the recording's own
  std::string depth_camera;     // of that file; empty: depth is registered
  double depth_scale = 0.0;     // raw units per metre; 0: as they say
  std::string motion_guess;     // file
  std::string groundtruth;      // file, or none; empty: the recording's own
  double max_damaged = 0.05;    // share of frames, see FrameStream
};

// Their rows.
std::vector<Setting> SettingTable(SequenceSettings* settings);

// A sequence that is open.
struct Sequence {
  std::unique_ptr<FrameSource> source;
  std::optional<Trajectory> ground_truth;  // if it is known before the frames
  bool compares = true;                    // with the recording's own
  std::optional<MotionGuess> motion_guess;
  double max_damaged = 0.05;         // share of frames
  std::vector<std::string> remarks;  // on its files, a line each, for users

  // For a run, as long as this lives.
  RunInputs inputs() const;

  // The ground truth once all frames have been read, when that of any recording
  // is known; null: there is none. As long as this lives.
  const Trajectory* GroundTruth();
};

// What of a source made no frame so far, a line each, as users see it: the
// first damaged ones, colour images without depth, frames that came too fast.
std::vector<std::string> DroppedFrames(const FrameSource& source,
                                       const std::vector<std::string>& damaged);

// `keep_color`: in Frame::color. `camera`: that the frames are seen by,
// whatever the settings say; null: as they say. Throws InputError for all that
// can be wrong with it before its images are read.
Sequence OpenSequence(const SequenceSettings& settings, bool keep_color = false,
                      const RgbdCamera* camera = nullptr);

}  // namespace rgbd_pose
