#include "apps/shell/available_cores.h"

#include <sched.h>

#include <algorithm>
#include <string>
#include <thread>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// More than any machine can use for this.
constexpr int kMaxThreads = 256;

}  // namespace

int AvailableCores() {
  // Unlike the number of cores of the machine, this heeds what a scheduler
  // such as Slurm has given.
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof(cores), &cores) == 0) {
    return std::max(1, CPU_COUNT(&cores));
  }
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int NumThreads(int flag) {
  if (flag < 0 || flag > kMaxThreads) {
    throw InputError("--threads must be 0 (one a core) to " +
                     std::to_string(kMaxThreads));
  }
  return flag > 0 ? flag : std::min(AvailableCores(), kMaxThreads);
}

}  // namespace rgbd_pose
