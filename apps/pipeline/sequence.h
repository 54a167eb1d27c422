#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/odometry_run.h"
#include "apps/pipeline/setting_table.h"
#include "core/evaluation/trajectory.h"
#include "frontend/sources/frame_source.h"
#include "frontend/tracking/motion_guess.h"

namespace rgbd_pose {

// A sequence and what is known of it, as users say it; empty: none.
struct SequenceSettings {
  std::string dataset;          // path of a recording
  std::string source = "auto";  // its kind, see OpenSource
  std::string associations;     // file
  std::string camera;           // file or preset
  double depth_scale = 0.0;     // raw units per metre; 0: the camera's
  std::string motion_guess;     // file
  std::string groundtruth;      // file; empty: that of the dataset, if any
};

// Their rows.
std::vector<Setting> SettingTable(SequenceSettings* settings);

// A sequence that is open.
struct Sequence {
  std::unique_ptr<FrameSource> source;
  std::optional<Trajectory> ground_truth;
  std::optional<MotionGuess> motion_guess;

  // For a run, as long as this lives.
  RunInputs inputs() const;
};

// `keep_color`: in Frame::color. Throws InputError for all that can be wrong
// with it before its images are read.
Sequence OpenSequence(const SequenceSettings& settings,
                      bool keep_color = false);

}  // namespace rgbd_pose
