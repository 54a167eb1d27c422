#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/calibration/calibration.h"
#include "apps/pipeline/odometry_run.h"
#include "apps/pipeline/sequence.h"
#include "apps/pipeline/slam.h"

namespace rgbd_pose {

// Settings to map a recording with that is to calibrate its camera: keyframes
// follow each other more closely than a map needs, so that small motions, too,
// have some, none is removed, and no more of them are paired than it takes.
OdometrySettings CalibrationOdometry();
SlamSettings CalibrationSlam();

// The path of all frames that were tracked as the odometry has it: without the
// steps of corrections.
Trajectory SmoothPath(const std::vector<SlamFrame>& frames);

// What came of a recording's calibration, and the path from above.
struct RecordingCalibration {
  CalibrationResult result;  // of all passes together
  Trajectory path;           // of the last map

  // Why the recording ended early, or empty; what of it is left out
  // (DroppedFrames).
  std::string stopped;
  int damaged = 0;  // frames
  std::vector<std::string> left_out;
};

// Hears of each frame that is tracked: in which pass, how many of it so far and
// of all (0: not known ahead).
using CalibrationProgress = std::function<void(int pass, int done, int all)>;

// Maps a recording and calibrates its camera from the map.
// Where depth turns out to be displaced by pixels all is done again with the
// camera found, which was far away from the first one. `on_frame` may be empty.
// Throws InputError as OpenSequence does, and for settings that are of no use.
RecordingCalibration CalibrateRecording(const SequenceSettings& sequence,
                                        const OdometrySettings& odometry,
                                        const SlamSettings& slam,
                                        const CalibrationSettings& settings,
                                        int threads,
                                        const CalibrationProgress& on_frame);

}  // namespace rgbd_pose
