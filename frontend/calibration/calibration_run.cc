#include "frontend/calibration/calibration_run.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "frontend/calibration/calibration_passes.h"

namespace rgbd_pose {
namespace {

// Returns the range of frames (first-last:step) that reduces the frame rate to
// `max_rate`, or an empty string if no frame has to be left out.
std::string ThinnedFrames(const std::vector<double>& timestamps,
                          double max_rate) {
  if (timestamps.size() < 2 || max_rate == 0.0) return "";
  std::vector<double> intervals;
  for (size_t i = 1; i < timestamps.size(); ++i) {
    intervals.push_back(timestamps[i] - timestamps[i - 1]);
  }
  // Tolerates slightly uneven timestamps.
  constexpr double kSlack = 0.1;
  const int step = static_cast<int>(
      std::min(1e9, std::ceil(1.0 / (Median(intervals) * max_rate) - kSlack)));
  if (step < 2) return "";
  return "0-" + std::to_string(timestamps.size() - 1) + ":" +
         std::to_string(step);
}

// The same for a recording, unless its settings name frames.
SequenceSettings Thinned(SequenceSettings sequence, double max_rate) {
  if (sequence.frames.empty()) {
    sequence.frames =
        ThinnedFrames(OpenSequence(sequence).source->timestamps(), max_rate);
  }
  return sequence;
}

// The settings with which all passes track.
OdometrySettings WithShutter(const OdometrySettings& odometry) {
  OdometrySettings with_shutter = odometry;
  with_shutter.odometry.shutter = ShutterUse::kCamera;
  with_shutter.odometry.max_time_shift = 1.0;  // see CalibrationOdometry
  // The noise is the same for all cameras and passes, because scatter is
  // measured relative to it.
  with_shutter.depth_noise = NoiseFor(odometry, {});
  return with_shutter;
}

// Maps a recording, and sets all of the result that concerns its frames.
void MapFrames(Sequence* sequence, int threads,
               const std::function<void()>& on_frame, SequenceRun* run,
               RecordingCalibration* all) {
  all->stopped = TrackAll(sequence->source.get(), threads, {run},
                          [&](const Frame& /*frame*/) {
                            on_frame();
                            return true;
                          });
  all->damaged = static_cast<int>(run->damaged().size());
  all->left_out = sequence->remarks;
  for (const auto& line : DroppedFrames(*sequence->source, run->damaged(),
                                        run->odometry().repeated())) {
    all->left_out.push_back(line);
  }
  run->Finish(sequence->GroundTruth());
  all->path = run->slam()->Path();
}

}  // namespace

OdometrySettings CalibrationOdometry() {
  OdometrySettings settings;
  settings.odometry.max_flow_px = 30.0;
  settings.odometry.max_time_shift = 1.0;  // m: depth is always aligned
  settings.features.max_features = 300;
  return settings;
}

SlamSettings CalibrationSlam() {
  SlamSettings settings;
  settings.mapping.redundant_share = 2.0;  // never reached
  settings.mapping.max_pairs = 4;
  settings.mapping.max_loop_candidates = 0;
  return settings;
}

Trajectory SmoothPath(const std::vector<SlamFrame>& frames) {
  Trajectory path;
  for (const SlamFrame& frame : frames) {
    if (frame.tracked.status == TrackingStatus::kLost) continue;
    path.push_back({frame.tracked.timestamp, frame.odom_from_cam});
  }
  return path;
}

RecordingCalibration CalibrateRecording(
    const SequenceSettings& sequence, const OdometrySettings& odometry,
    const SlamSettings& slam, const CalibrationSettings& settings, int threads,
    const std::function<void(int pass, int done, int all)>& on_frame,
    const std::function<void(int pass, int done)>& on_iteration) {
  RequireSound(settings.Check(), "calibration: ");
  const OdometrySettings with_shutter = WithShutter(odometry);
  const SequenceSettings part = Thinned(sequence, settings.max_rate);
  std::optional<RgbdCamera> known;
  if (odometry.odometry.shutter == ShutterUse::kNone) {
    // The shutter is to be estimated from zero.
    known = OpenSequence(sequence).source->camera();
    known->color_shutter = known->depth_shutter = Shutter();
  }
  RecordingCalibration all;
  RgbdCamera first;
  FreeParts found_earlier;
  for (int pass = 1;; ++pass) {
    Sequence opened = OpenSequence(part, /*keep_color=*/false,
                                   known.has_value() ? &*known : nullptr);
    opened.inputs.imu.reset();  // it says nothing of the camera
    const int frames = static_cast<int>(opened.source->timestamps().size());
    const RgbdCamera camera = opened.source->camera();
    SequenceRun run(with_shutter, slam, camera, opened.inputs);
    int done = 0, iterations = 0;
    const auto count_frame = [&] {
      if (on_frame) on_frame(pass, ++done, frames);
    };
    MapFrames(&opened, threads, count_frame, &run, &all);
    const CalibrationResult result = Calibrate(
        run.slam()->Map(), SmoothPath(run.slam_frames()), camera, with_shutter,
        settings, {opened.GroundTruth(), opened.inputs.motion_guess.get()},
        threads, pass > 1 ? &first : nullptr, found_earlier, [&] {
          if (on_iteration) on_iteration(pass, ++iterations);
        });
    if (pass == 1) {
      first = camera;
      all.result = result;
    } else {
      TakeUp(first, settings, result, &all.result);
    }
    // A live camera cannot be read again.
    if (frames == 0 || pass >= settings.max_passes ||
        !IsAnotherPassDue(result)) {
      return all;
    }
    known = all.result.found;
    found_earlier = all.result.Determined();
  }
}

}  // namespace rgbd_pose
