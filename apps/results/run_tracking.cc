#include <gflags/gflags.h>

#include <csignal>
#include <cstdio>

#include "apps/pipeline/sequence.h"
#include "apps/results/run_output.h"
#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "frontend/frame/depth_lookup.h"

DEFINE_bool(finish_on_signal, true,
            "on SIGINT (Ctrl-C) or SIGTERM stop early and keep the results; a "
            "second signal ends the program at once");

namespace rgbd_pose {
namespace {

// A run with a smaller share of tracked frames has failed.
constexpr double kMinTrackedShare = 0.5;

constexpr int kSignals[] = {SIGINT, SIGTERM};

volatile std::sig_atomic_t came = 0;
struct sigaction before[2];

void Remember(int signal) { came = signal; }

// While this object lives and --finish_on_signal is set, SIGINT and SIGTERM ask
// the program to stop early and to keep its results; a second signal ends it at
// once. Without the flag, signals end the program as usual. Ignored signals
// stay ignored. Only one object may exist at a time.
class StopSignal {
 public:
  StopSignal() {
    came = 0;
    struct sigaction action = {};
    action.sa_handler = Remember;
    // A second one ends the program.
    action.sa_flags = SA_RESETHAND | SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < 2; ++i) {
      sigaction(kSignals[i], nullptr, &before[i]);
      if (FLAGS_finish_on_signal && before[i].sa_handler != SIG_IGN) {
        sigaction(kSignals[i], &action, nullptr);
      }
    }
  }
  // Restores the previous signal handlers.
  ~StopSignal() {
    for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &before[i], nullptr);
  }
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  // The name of the received signal, or empty.
  std::string name() const {
    return came == SIGINT ? "SIGINT" : came == SIGTERM ? "SIGTERM" : "";
  }
};

}  // namespace

std::string TrackSource(FrameSource* source, int threads, SequenceRun* run,
                        RunOutput* output, const FrameWatcher& watcher) {
  const StopSignal signal;
  const size_t size = source->timestamps().size();
  std::string ended_by;
  ProgressBar bar("tracking", static_cast<int>(size));
  const std::string stopped =
      TrackAll(source, threads, {run}, [&](const Frame& frame) {
        if (run->frames().size() == 1) {
          Warn({source->camera().camera.SanityWarning(),
                DepthScaleWarning(frame)});
        }
        output->Add(frame, *run);
        bar.Update(static_cast<int>(run->frames().size()));
        if (watcher) ended_by = watcher(frame, [] { return came != 0; });
        if (!signal.name().empty()) ended_by = signal.name();
        return ended_by.empty();
      });
  Warn(DroppedFrames(*source, run->damaged()));
  if (!stopped.empty()) return stopped;
  return run->frames().size() + run->damaged().size() == size ? "" : ended_by;
}

int ExitCodeOf(const std::string& program, const RunResults& results,
               const std::string& folder, const std::string& stopped,
               const std::string& no_report) {
  if (!no_report.empty()) {
    std::fprintf(stderr, "%s: %s; all other results are in %s\n",
                 program.c_str(), no_report.c_str(), folder.c_str());
    return kExitBadInput;
  }
  if (results.TrackedShare() < kMinTrackedShare) {
    std::fprintf(stderr,
                 "%s: only %.1f %% of the frames were tracked; see the reasons "
                 "in %s/frames.csv\n",
                 program.c_str(), 100.0 * results.TrackedShare(),
                 folder.c_str());
    return kExitTrackingFailed;
  }
  if (!stopped.empty()) {
    std::fprintf(stderr,
                 "%s: stopped after %zu frames (%s); their results are in %s\n",
                 program.c_str(), results.frames.size(), stopped.c_str(),
                 folder.c_str());
    return kExitStopped;
  }
  return kExitOk;
}

}  // namespace rgbd_pose
