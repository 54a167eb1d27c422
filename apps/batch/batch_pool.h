#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/batch/batch_plan.h"
#include "apps/batch/batch_run_folder.h"

namespace rgbd_pose {

// Starts a program (path and arguments) in a folder, with nothing to read and
// its output in run.log there. It is killed when this process ends, however
// that ends; so call this from the main thread. Throws InputError if no process
// can be made; a program that cannot be run exits with 127.
pid_t StartProcess(const std::vector<std::string>& command,
                   const std::string& folder);

// The state of waitpid once the process has ended; empty until then.
std::optional<int> PollProcess(pid_t process);

struct BatchPoolOptions {
  std::string program;                      // path of rgbd_odometry
  std::vector<std::string> arguments = {};  // for every run, before its own
  int jobs = 1;                             // processes at a time
  double timeout_seconds = 0.0;             // for one run; 0: none

  // Hears of each run when it has ended and is in its place; may be empty.
  std::function<void(const BatchRun& run, const RunEnd& end, double seconds)>
      on_end = {};
};

// Runs all, each in a process of its own, started in the order given. A run
// that fails, crashes or takes too long does not stop the others.
void RunBatch(const std::vector<BatchRun>& runs, const BatchFolder& folder,
              const BatchPoolOptions& options);

}  // namespace rgbd_pose
