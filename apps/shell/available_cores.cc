#include "apps/shell/available_cores.h"

#include <sched.h>

#include <algorithm>
#include <thread>

namespace rgbd_pose {

int AvailableCores() {
  // Unlike the number of cores of the machine, this heeds what a scheduler
  // such as Slurm has given.
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof(cores), &cores) == 0) {
    return std::max(1, CPU_COUNT(&cores));
  }
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace rgbd_pose
