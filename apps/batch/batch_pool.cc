#include "apps/batch/batch_pool.h"

#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <thread>

#include "apps/batch/batch_process.h"

namespace rgbd_pose {
namespace {

using Clock = std::chrono::steady_clock;

// Short compared with any run, long compared with what looking costs.
constexpr auto kLookEvery = std::chrono::milliseconds(10);

struct Process {
  const BatchRun* run;
  pid_t id;
  Clock::time_point start;
  bool timed_out = false;

  double Seconds() const {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }
};

// A run works in its own folder and calls it ".": its files do not tell where
// that was, and the folder may be renamed.
std::vector<std::string> CommandOf(const BatchRun& run,
                                   const BatchPoolOptions& options) {
  std::vector<std::string> command = {options.program};
  command.insert(command.end(), options.arguments.begin(),
                 options.arguments.end());
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
  RunEnd end;
  end.hash = process.run->hash;
  if (WIFEXITED(state)) {
    end.exit_code = WEXITSTATUS(state);
    end.status = end.exit_code == 0 ? "ok" : "failed";
  } else {
    end.exit_code = 128 + WTERMSIG(state);
    end.status = process.timed_out ? "timeout" : "crashed";
  }
  return end;
}

}  // namespace

void RunBatch(const std::vector<BatchRun>& runs, const BatchFolder& folder,
              const BatchPoolOptions& options) {
  std::vector<Process> processes;
  auto next = runs.begin();
  while (next != runs.end() || !processes.empty()) {
    while (next != runs.end() &&
           static_cast<int>(processes.size()) < options.jobs) {
      folder.Begin(*next);
      processes.push_back(
          {&*next,
           StartProcess(CommandOf(*next, options), folder.Partial(*next)),
           Clock::now()});
      ++next;
    }
    std::vector<Process> running;
    for (Process& process : processes) {
      const std::optional<int> state = PollProcess(process.id);
      if (state) {
        const RunEnd end = EndOf(process, *state);
        folder.Finish(*process.run, end);
        if (options.on_end) {
          options.on_end(*process.run, end, process.Seconds());
        }
        continue;
      }
      if (options.timeout_seconds > 0.0 && !process.timed_out &&
          process.Seconds() > options.timeout_seconds) {
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
