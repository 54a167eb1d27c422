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
  action.sa_handler = FLAGS_finish_on_signal ? Remember : SIG_DFL;
  action.sa_flags = SA_RESETHAND | SA_RESTART;  // the next one does its work
  sigemptyset(&action.sa_mask);
  for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &action, &before[i]);
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
