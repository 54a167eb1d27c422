#include "apps/shell/calibration_progress.h"

#include <memory>

#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"

namespace rgbd_pose {

RecordingCalibration CalibrateWithProgress(const SequenceSettings& sequence,
                                           const OdometrySettings& odometry,
                                           const SlamSettings& slam,
                                           const CalibrationSettings& settings,
                                           int threads) {
  std::unique_ptr<ProgressBar> bar;
  int shown = 0;
  RecordingCalibration calibration = CalibrateRecording(
      sequence, odometry, slam, settings, threads,
      [&](int pass, int done, int all) {
        if (pass != shown) {
          bar.reset();
          bar = std::make_unique<ProgressBar>(
              pass == 1 ? "calibrating" : "calibrating again", all);
          shown = pass;
        }
        bar->Update(done);
      });
  Warn(calibration.left_out);
  return calibration;
}

}  // namespace rgbd_pose
