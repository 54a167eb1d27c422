#include "apps/shell/stop_signal.h"

#include <gflags/gflags.h>

#include <csignal>

DEFINE_bool(finish_on_signal, true,
            "at SIGINT (Ctrl-C) or SIGTERM keep the results so far; a second "
            "one ends the program at once");

namespace rgbd_pose {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM};

volatile std::sig_atomic_t came = 0;
struct sigaction before[2];

void Remember(int signal) { came = signal; }

}  // namespace

StopSignal::StopSignal() {
  came = 0;
  struct sigaction action = {};
  action.sa_handler = Remember;
  action.sa_flags = SA_RESETHAND | SA_RESTART;  // the next one does its work
  sigemptyset(&action.sa_mask);
  for (int i = 0; i < 2; ++i) {
    sigaction(kSignals[i], nullptr, &before[i]);
    // Who has started the program in the background may want it left alone.
    const bool is_ignored = before[i].sa_handler == SIG_IGN;
    if (FLAGS_finish_on_signal && !is_ignored) {
      sigaction(kSignals[i], &action, nullptr);
    }
  }
}

StopSignal::~StopSignal() {
  for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &before[i], nullptr);
}

std::string StopSignal::name() const {
  switch (came) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    default:
      return "";
  }
}

}  // namespace rgbd_pose
