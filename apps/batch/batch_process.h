#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace rgbd_pose {

// Starts a program (path and arguments) in a folder, with nothing to read and
// its output in run.log there. It is killed when this process ends, however
// that ends; so call this from the main thread. Throws InputError if no process
// can be made; a program that cannot be run exits with 127.
pid_t StartProcess(const std::vector<std::string>& command,
                   const std::string& folder);

// The state of waitpid once the process has ended; empty until then.
std::optional<int> PollProcess(pid_t process);

}  // namespace rgbd_pose
