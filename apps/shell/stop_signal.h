#pragma once

#include <string>
#include <thread>

namespace rgbd_pose {

// While this object lives, SIGINT (Ctrl-C), SIGTERM and SIGHUP (its terminal is
// closed) end the program as usual, but what it has not finished in folders is
// removed before. Ignored signals stay ignored. Only one object may exist at a
// time.
class CleanEnd {
 public:
  CleanEnd();
  ~CleanEnd();
  CleanEnd(const CleanEnd&) = delete;
  CleanEnd& operator=(const CleanEnd&) = delete;

 private:
  // Waits for the first signal: a handler itself may not remove folders.
  std::thread waiting_;
};

// While this object lives, these signals ask the program to stop early and to
// keep its results; a second signal, but for SIGHUP, ends it at once. Ignored
// signals stay ignored. Only one object may exist at a time.
class StopSignal {
 public:
  // With `is_used` false, signals end the program as before.
  explicit StopSignal(bool is_used = true);
  // Restores the previous signal handlers.
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  // The name of the received signal, or empty.
  std::string name() const;

 private:
  const bool is_used_;
};

}  // namespace rgbd_pose
