#pragma once

#include <gflags/gflags_declare.h>

#include <chrono>
#include <optional>
#include <string>

#include "apps/export/ros2_recording.h"
#include "apps/results/run_output.h"
#include "apps/shell/program.h"
#include "apps/view/live_view.h"
#include "frontend/calibration/calibration_run.h"
#include "frontend/settings/sequence.h"

// A flag of rgbd_odometry and rgbd_slam, like --report and --finish_on_signal.
DECLARE_int32(threads);

namespace rgbd_pose {

// The settings that rgbd_odometry and rgbd_slam share.
struct RunSettings {
  SequenceSettings sequence;
  OdometrySettings odometry;
  RunOutputSettings output;
  ViewSettings view;
  std::string save_map;  // folder; empty: the map, if any, is not saved

  // Whether anything shows or keeps colours.
  bool wants_color() const { return view.view || !output.record.empty(); }
};

// Tracks the frames of a source, with a progress bar and warnings. Returns why
// it ended early (a signal, the page's stop button, a failing source, too many
// damaged frames), or empty. `recording` may be null. Throws InputError if no
// frame was read.
std::string TrackSource(FrameSource* source, int threads, SequenceRun* run,
                        RunOutput* output, Ros2Recording* recording,
                        LiveView* view);

// The rest of a program after its sequence was opened: tracks the frames,
// writes, shows and prints all results. `start` is that of the program, `found`
// the calibration of the camera, if there was one. Returns the exit code.
int TrackAndWrite(const RunSettings& settings, const ProgramInfo& info,
                  std::chrono::steady_clock::time_point start,
                  Sequence* sequence, SequenceRun* run,
                  const std::optional<RecordingCalibration>& found = {});

}  // namespace rgbd_pose
