#include "apps/shell/stop_signal.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "core/util/input_error.h"
#include "core/util/locked_folder.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};
constexpr int kNumSignals = sizeof(kSignals) / sizeof(kSignals[0]);

// The signal handlers before an object replaced them.
class Handlers {
 public:
  // Sets a handler for the signals that are not ignored.
  void Replace(void (*handler)(int)) {
    for (int i = 0; i < kNumSignals; ++i) {
      sigaction(kSignals[i], nullptr, &before_[i]);
    }
    struct sigaction action = {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < kNumSignals; ++i) {
      if (before_[i].sa_handler == SIG_IGN) continue;
      sigaction(kSignals[i], &action, nullptr);
    }
  }
  void Restore() const {
    for (int i = 0; i < kNumSignals; ++i) {
      sigaction(kSignals[i], &before_[i], nullptr);
    }
  }

 private:
  struct sigaction before_[kNumSignals] = {};
};

// The state of CleanEnd, for its signal handler.
int pipe_ends[2];  // signal numbers; 0: the object ends
Handlers before_clean_end;

// The state of StopSignal, for its signal handler.
volatile std::sig_atomic_t came = 0;
Handlers before_stop;

void SendThroughPipe(char number) {
  // If the pipe is full, it holds a signal already.
  const ssize_t written = write(pipe_ends[1], &number, 1);
  static_cast<void>(written);
}

}  // namespace

CleanEnd::CleanEnd() {
  if (pipe2(pipe_ends, O_CLOEXEC) != 0) {
    throw InputError("no pipe can be opened " + LastFailure());
  }
  waiting_ = std::thread([] {
    char number = 0;
    while (read(pipe_ends[0], &number, 1) < 0 && errno == EINTR) {
    }
    if (number == 0) return;
    LockedFolder::RemoveAll();
    std::signal(number, SIG_DFL);
    kill(getpid(), number);
  });
  before_clean_end.Replace([](int signal) {
    const int error = errno;  // of what was interrupted
    SendThroughPipe(static_cast<char>(signal));
    errno = error;
  });
}

CleanEnd::~CleanEnd() {
  before_clean_end.Restore();
  SendThroughPipe(0);
  waiting_.join();
  for (const int end : pipe_ends) close(end);
}

StopSignal::StopSignal(bool is_used) : is_used_(is_used) {
  came = 0;
  if (!is_used_) return;
  before_stop.Replace([](int signal) {
    came = signal;
    before_stop.Restore();  // a second one ends the program
    // A terminal that is closed sends it more than once.
    if (signal == SIGHUP) std::signal(SIGHUP, SIG_IGN);
  });
}

StopSignal::~StopSignal() {
  if (is_used_) before_stop.Restore();
}

std::string StopSignal::name() const {
  switch (came) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    default:
      return "";
  }
}

}  // namespace rgbd_pose
