#pragma once

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace rgbd_pose {

// Has the calling thread, and those it starts, go after the other threads of
// the program where cores are short: for work that nobody waits for yet. Does
// nothing but on Linux, where threads have priorities of their own.
inline void LowerThreadPriority() {
#ifdef __linux__
  constexpr int kSteps = 5;  // a third of the time of an equal
  setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kSteps);
#endif
}

}  // namespace rgbd_pose
