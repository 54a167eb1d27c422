#pragma once

#include <functional>
#include <string>
#include <vector>

#include "frontend/calibration/calibration.h"
#include "frontend/settings/sequence.h"
#include "frontend/slam/sequence_run.h"
#include "frontend/slam/slam.h"

namespace rgbd_pose {

// Settings for mapping a recording that its camera is to be calibrated from:
// keyframes are closer than a map needs (also yields pairs for small motions),
// none is removed, and only as many are paired as needed.
OdometrySettings CalibrationOdometry();
SlamSettings CalibrationSlam();

// The path of all tracked frames by odometry, without jumps of map corrections.
Trajectory SmoothPath(const std::vector<SlamFrame>& frames);

// The calibration of a recording, and the path of the frames.
struct RecordingCalibration {
  CalibrationResult result;  // of all passes together
  Trajectory path;           // of the last map

  std::string stopped;                // why the recording ended early, or empty
  int damaged = 0;                    // number of damaged frames
  std::vector<std::string> left_out;  // frames and why, see DroppedFrames
};

// Maps a recording and calibrates its camera from the map; again with the
// camera found if depth was displaced by more than a pixel. `on_frame`, if not
// empty, is called for each tracked frame with the pass, the number of frames
// done in it and of all frames (0 if not known in advance); `on_iteration`
// after them for each iteration of the solver, with the pass and the number of
// iterations in it. Throws InputError as OpenSequence does, and for invalid
// settings.
RecordingCalibration CalibrateRecording(
    const SequenceSettings& sequence, const OdometrySettings& odometry,
    const SlamSettings& slam, const CalibrationSettings& settings, int threads,
    const std::function<void(int pass, int done, int all)>& on_frame,
    const std::function<void(int pass, int done)>& on_iteration = {});

}  // namespace rgbd_pose
