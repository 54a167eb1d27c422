#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/batch/batch_plan.h"
#include "apps/batch/batch_run_folder.h"

namespace rgbd_pose {

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
