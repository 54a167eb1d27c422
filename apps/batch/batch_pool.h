#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/batch/batch_plan.h"
#include "apps/batch/batch_run_folder.h"

namespace rgbd_pose {

struct BatchPoolOptions {
  // The path of rgbd_odometry, and arguments of every run before its own.
  std::vector<std::string> command;

  int jobs = 1;                  // processes at a time
  double timeout_seconds = 0.0;  // per run; 0: none

  // Called for each run after it has ended and is in its folder.
  std::function<void(const BatchRun& run, const RunEnd& end, double seconds)>
      on_end;
};

// Executes all runs, each in its own process, started in the given order. A run
// that fails, crashes or takes too long does not stop the others.
void RunBatch(const std::vector<BatchRun>& runs, const BatchFolder& folder,
              const BatchPoolOptions& options);

}  // namespace rgbd_pose
