#pragma once

#include <string>

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

}  // namespace rgbd_pose
