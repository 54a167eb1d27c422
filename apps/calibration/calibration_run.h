#pragma once

#include <functional>
#include <string>

#include "apps/calibration/calibration.h"
#include "apps/pipeline/sequence.h"
#include "apps/pipeline/slam_run.h"
#include "apps/pipeline/slam_settings.h"

namespace rgbd_pose {

// Settings to map a recording with that is to calibrate its camera: keyframes
// follow each other more closely than a map needs, so that small motions, too,
// have some, none is removed, and no more of them are paired than it takes.
OdometrySettings CalibrationOdometry();
SlamSettings CalibrationSlam();

// Maps a recording with the camera that is there, then calibrates that camera
// from the map.
class CalibrationRun {
 public:
  // The sequence must outlive it. Throws InputError for settings that are of no
  // use.
  CalibrationRun(const OdometrySettings& odometry, const SlamSettings& slam,
                 const CalibrationSettings& settings, Sequence* sequence);

  // Tracks all frames; `on_frame` hears of each, may be empty. Returns why the
  // source ended before its last frame, see TrackAll.
  std::string Track(FrameSource* source, int threads,
                    const std::function<void()>& on_frame);

  // After that, once: what came of it. `known`: see Calibrate.
  CalibrationResult Solve(int threads, const RgbdCamera* known = nullptr);

  // After that: the map and the path it was made from.
  const SlamRun& run() const { return run_; }

 private:
  const OdometrySettings odometry_;
  const CalibrationSettings settings_;
  Sequence* const sequence_;
  const RgbdCamera first_;
  SlamRun run_;
};

// The path of all frames that were tracked as the odometry has it: without the
// steps of corrections.
Trajectory SmoothPath(const std::vector<SlamFrame>& frames);

}  // namespace rgbd_pose
