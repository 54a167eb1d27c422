#include "apps/shell/stop_signal.h"

#include <csignal>

namespace rgbd_pose {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM};

volatile std::sig_atomic_t came = 0;
struct sigaction before[2];

}  // namespace

StopSignal::StopSignal(bool is_used) {
  came = 0;
  struct sigaction action = {};
  action.sa_handler = [](int signal) { came = signal; };
  // A second one ends the program.
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (int i = 0; i < 2; ++i) {
    sigaction(kSignals[i], nullptr, &before[i]);
    if (is_used && before[i].sa_handler != SIG_IGN) {
      sigaction(kSignals[i], &action, nullptr);
    }
  }
}

StopSignal::~StopSignal() {
  for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &before[i], nullptr);
}

std::string StopSignal::name() const {
  return came == SIGINT ? "SIGINT" : came == SIGTERM ? "SIGTERM" : "";
}

}  // namespace rgbd_pose
