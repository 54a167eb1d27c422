#include "apps/batch/batch_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

constexpr int kCannotRun = 127;  // as shells have it

// In the new process: only calls that are safe between fork and exec.
// posix_spawn will not do, as it cannot tie a process to its parent's life.
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

}  // namespace

pid_t StartProcess(const std::vector<std::string>& command,
                   const std::string& folder) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
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

std::optional<int> PollProcess(pid_t process) {
  int state = 0;
  if (waitpid(process, &state, WNOHANG) != process) return std::nullopt;
  return state;
}

}  // namespace rgbd_pose
