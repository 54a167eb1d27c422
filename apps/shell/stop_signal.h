#pragma once

#include <string>

namespace rgbd_pose {

// While this object lives, SIGINT (Ctrl-C) and SIGTERM ask the program to stop
// early and to keep its results; a second signal ends it at once. Ignored
// signals stay ignored. Only one object may exist at a time.
class StopSignal {
 public:
  // With `is_used` false, signals end the program as usual.
  explicit StopSignal(bool is_used = true);
  // Restores the previous signal handlers.
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  // The name of the received signal, or empty.
  std::string name() const;
};

}  // namespace rgbd_pose
