#pragma once

#include <functional>
#include <string>

#include "apps/pipeline/odometry_run.h"
#include "apps/results/run_output.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// While this object lives and --finish_on_signal is set, SIGINT and SIGTERM ask
// the program to stop early and to keep its results; a second signal ends it at
// once. Without the flag, signals end the program as usual. Ignored signals
// stay ignored. Only one object may exist at a time.
class StopSignal {
 public:
  StopSignal();
  // Restores the previous signal handlers.
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  // The name of the received signal, or empty.
  std::string name() const;
};

// Problems that make a run incomplete although it has results.
struct RunIssues {
  std::string stopped;    // why it ended before the last frame
  std::string no_report;  // why there is no page
};

// Called for each tracked frame. Returns why the run is to end, or an empty
// string. A watcher that waits must check the signal.
using FrameWatcher =
    std::function<std::string(const Frame& frame, const StopSignal& signal)>;

// Tracks the frames of a source, with a progress bar and warnings. `watcher`
// may be empty. Returns why the run ended before the last frame (a signal, the
// watcher, a source that fails, too many damaged frames), or an empty string.
// Throws InputError if no frame was read.
std::string TrackSource(FrameSource* source, int threads, SequenceRun* run,
                        RunOutput* output, const FrameWatcher& watcher = {});

// Logs what the errors of a run suggest about its input.
void LogWarnings(const RunResults& results);

// Returns the exit code after everything is written, and prints one line on
// stderr unless it is kExitOk.
int ExitCodeOf(const std::string& program, const RunResults& results,
               const std::string& folder, const RunIssues& flaws);

}  // namespace rgbd_pose
