#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "apps/batch/batch_runs.h"
#include "apps/shell/program.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

constexpr int kCannotRun = 127;  // as in shells

// Runs in the new process, so only calls are used that are safe between fork
// and exec. posix_spawn will not do, because it cannot tie the child's life to
// its parent.
[[noreturn]] void RunInChild(pid_t parent, char* const* arguments,
                             const char* folder) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kCannotRun);  // it has ended meanwhile
  if (chdir(folder) != 0) _exit(kCannotRun);
  const int input = open("/dev/null", O_RDONLY | O_CLOEXEC);
  const int output =
      open("run.log", O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (input < 0 || output < 0 || dup2(input, STDIN_FILENO) < 0 ||
      dup2(output, STDOUT_FILENO) < 0 || dup2(output, STDERR_FILENO) < 0) {
    _exit(kCannotRun);
  }
  execv(arguments[0], arguments);
  _exit(kCannotRun);
}

// This is short compared with a run, and long compared with the cost of
// polling.
constexpr auto kLookEvery = std::chrono::milliseconds(10);

struct Process {
  const BatchRun* run;
  pid_t id;
  std::chrono::steady_clock::time_point start;
  bool timed_out = false;
};

// A run works in its own folder and refers to it as ".". Its files therefore do
// not contain the path, and the folder may be renamed.
std::vector<std::string> CommandOf(const BatchRun& run,
                                   const BatchPoolOptions& options) {
  std::vector<std::string> command = options.command;
  for (size_t k = 0; k < run.values.size(); ++k) {
    command.push_back(std::string("--") + BatchSettings()[k].flag + "=" +
                      run.values[k]);
  }
  command.insert(command.end(), {"--dataset=" + run.sequence.folder,
                                 "--camera=" + run.sequence.camera,
                                 "--threads=1", "--output=."});
  return command;
}

RunEnd EndOf(const Process& process, int state) {
  if (WIFEXITED(state)) {
    const int code = WEXITSTATUS(state);
    return {code == 0 ? "ok" : "failed", code, process.run->hash};
  }
  return {process.timed_out ? "timeout" : "crashed", 128 + WTERMSIG(state),
          process.run->hash};
}

// Starts a program (path and arguments) in a folder, without input and with its
// output in run.log there. It is killed when this process ends in any way, so
// call this from the main thread. Throws InputError if no process can be
// created; a program that cannot be executed exits with 127.
pid_t StartProcess(std::vector<std::string> command,
                   const std::string& folder) {
  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) RunInChild(parent, arguments.data(), folder.c_str());
  if (child < 0) {
    throw InputError(command[0] + ": cannot be started (" +
                     std::strerror(errno) + "); use fewer --jobs");
  }
  return child;
}

}  // namespace

void RunBatch(const std::vector<BatchRun>& runs, const BatchFolder& folder,
              const BatchPoolOptions& options) {
  // Where this signal is ignored, ended runs cannot be waited for.
  std::signal(SIGCHLD, SIG_DFL);
  std::vector<Process> processes;
  auto next = runs.begin();
  while (next != runs.end() || !processes.empty()) {
    while (next != runs.end() &&
           static_cast<int>(processes.size()) < options.jobs) {
      folder.Begin(*next);
      processes.push_back(
          {&*next,
           StartProcess(CommandOf(*next, options), folder.Partial(*next)),
           std::chrono::steady_clock::now()});
      ++next;
    }
    std::vector<Process> running;
    for (Process& process : processes) {
      int state = 0;
      if (waitpid(process.id, &state, WNOHANG) == process.id) {
        const RunEnd end = EndOf(process, state);
        folder.Finish(*process.run, end);
        options.on_end(*process.run, end, SecondsSince(process.start));
        continue;
      }
      if (options.timeout_seconds > 0.0 && !process.timed_out &&
          SecondsSince(process.start) > options.timeout_seconds) {
        kill(process.id, SIGKILL);
        process.timed_out = true;
      }
      running.push_back(process);
    }
    if (running.size() == processes.size()) {
      std::this_thread::sleep_for(kLookEvery);
    }
    processes = std::move(running);
  }
}

}  // namespace rgbd_pose
