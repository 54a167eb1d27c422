#pragma once

#include <functional>
#include <string>

#include "apps/pipeline/odometry_run.h"
#include "apps/results/run_output.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// While it lives, SIGINT and SIGTERM ask a program to end its work early and
// to keep what it has, if --finish_on_signal (else they end it, as always). A
// second one ends it at once. Signals that are ignored stay so. One at a time.
class StopSignal {
 public:
  StopSignal();
  // Signals mean again what they meant before.
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  // The name of the signal that came, or empty.
  std::string name() const;
};

// What keeps a run from being whole though it has results.
struct RunIssues {
  std::string stopped;    // why it ended before the last frame
  std::string no_report;  // why there is no page
};

// Hears of each frame that was tracked; returns why the run is to end, or
// nothing. Who waits there looks at the signal.
using FrameWatcher =
    std::function<std::string(const Frame& frame, const StopSignal& signal)>;

// Tracks the frames of a source, with a progress bar and the warnings that
// people should see; `watcher` may be empty. Returns why it ended before the
// last frame, or nothing: a signal (StopSignal), its watcher, a source that
// gave no further frame, too many damaged ones. Throws InputError where there
// was no frame at all.
std::string TrackSource(FrameSource* source, int threads, SequenceRun* run,
                        RunOutput* output, const FrameWatcher& watcher = {});

// Says on stderr what the errors of a run tell of its input.
void LogWarnings(const RunResults& results);

// What the program exits with once all is written, with one line on stderr
// where that is not kExitOk.
int ExitCodeOf(const std::string& program, const RunResults& results,
               const std::string& folder, const RunIssues& flaws);

}  // namespace rgbd_pose
