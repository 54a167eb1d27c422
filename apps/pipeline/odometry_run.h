#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/pipeline/estimator_settings.h"
#include "core/estimation/estimator.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "frontend/sources/frame_source.h"
#include "frontend/tracking/motion_guess.h"
#include "frontend/tracking/odometry.h"

namespace rgbd_pose {

// The settings of a run by name, as programs take them.
struct OdometrySettings : EstimatorSettings {
  std::string frontend = "patch";
  std::string initial_guess = "last";
  std::string on_lost = "new_segment";
  std::string depth_noise = "khoshelham";
  int max_features = 600;
};

// The names of initial guesses: last (the last pose), velocity (moved on as it
// moved last) or one of core/initial_guess/initial_guess.h.
std::vector<std::string> OdometryGuessNames();

// What to do with lost frames (LostPolicy).
std::vector<std::string> LostPolicyNames();

// An odometry with these settings. Throws InputError for unknown names.
Odometry MakeOdometry(const OdometrySettings& settings, const Camera& camera);

struct RunOptions {
  int threads = 1;  // that read frames ahead and track

  const MotionGuess* motion_guess = nullptr;  // null: nothing else is known

  // Hears of each frame after it was tracked; may be empty.
  std::function<void(const Frame& frame, const TrackedFrame& tracked)> on_frame;
};

// Tracks all frames of a source: one result a frame, in order.
std::vector<TrackedFrame> RunOdometry(FrameSource* source, Odometry* odometry,
                                      const RunOptions& options);

// Reads all frames of a source in the same way and does nothing with them.
// Returns how long each frame took (ms); throws InputError for the first
// unreadable one.
std::vector<double> ReadAllFrames(
    FrameSource* source, int threads,
    const std::function<void(int done)>& progress);

// The poses of all frames that were not lost.
Trajectory TrackedTrajectory(const std::vector<TrackedFrame>& frames);

// frames.csv: a header and one row an input frame.
std::string FormatFramesCsv(const std::vector<TrackedFrame>& frames);

}  // namespace rgbd_pose
