#include "apps/calibration/calibration_run.h"

#include "core/util/input_error.h"

namespace rgbd_pose {

OdometrySettings CalibrationOdometry() {
  OdometrySettings settings;
  settings.odometry.max_flow_px = 30.0;
  settings.features.max_features = 300;
  return settings;
}

SlamSettings CalibrationSlam() {
  SlamSettings settings;
  settings.mapping.redundant_share = 2.0;  // which no view reaches
  settings.mapping.max_pairs = 4;
  settings.mapping.max_loop_candidates = 0;
  return settings;
}

CalibrationRun::CalibrationRun(const OdometrySettings& odometry,
                               const SlamSettings& slam,
                               const CalibrationSettings& settings,
                               Sequence* sequence)
    : odometry_(odometry),
      settings_(settings),
      sequence_(sequence),
      first_(sequence->source->camera()),
      run_(odometry, slam, first_.camera, sequence->inputs()) {
  const std::string error = settings.Check();
  if (!error.empty()) throw InputError("calibration: " + error);
}

std::string CalibrationRun::Track(FrameSource* source, int threads,
                                  const std::function<void()>& on_frame) {
  return TrackAll(source, threads, {&run_}, [&](const Frame& /*frame*/) {
    if (on_frame) on_frame();
    return true;
  });
}

CalibrationResult CalibrationRun::Solve(int threads, const RgbdCamera* known) {
  const Trajectory* const truth = sequence_->GroundTruth();
  run_.Finish(truth);
  return Calibrate(run_.slam().Map(), SmoothPath(run_.slam_frames()), first_,
                   odometry_, settings_,
                   {truth, sequence_->inputs().motion_guess}, threads, known);
}

Trajectory SmoothPath(const std::vector<SlamFrame>& frames) {
  Trajectory path;
  for (const SlamFrame& frame : frames) {
    if (frame.tracked.status == TrackingStatus::kLost) continue;
    path.push_back({frame.tracked.timestamp, frame.odom_from_cam});
  }
  return path;
}

}  // namespace rgbd_pose
