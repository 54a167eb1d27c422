#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "apps/pipeline/settings.h"

namespace rgbd_pose {

// What every program of the project exits with.
enum ExitCode {
  kExitOk = 0,
  kExitUsage = 1,           // called without what it needs
  kExitBadInput = 2,        // a flag, file or image that cannot be used
  kExitTrackingFailed = 3,  // ran, but the result is not usable
  kExitSomeFailed = 4,      // some items of a batch failed
  kExitCameraKept = 5,      // no better camera was found than the one there is
  kExitStopped = 6,         // by a signal, or no frame could be read
};

// Flags shown together in --help.
struct FlagGroup {
  std::string title;
  std::vector<std::string> flags;
};

// What --help says of a program.
struct ProgramInfo {
  std::string name;
  std::string summary;  // one sentence
  std::string example;  // one call
  std::vector<FlagGroup> flag_groups;
  // Flags that take a name of a list: which names there are.
  std::map<std::string, std::vector<std::string>> choices = {};
  // Tables of settings whose rows are flags, shown before the groups above.
  // What they write to must live as long as the program.
  std::vector<std::vector<Setting>> settings = {};
};

// Runs a program: --help and --version first, then the flags (one clear line
// and exit 2 for an unknown flag or a value of the wrong type), logging to
// stderr and the settings, then `body`, whose InputError becomes one line on
// stderr and exit 2. Call it from main with main's own arguments.
int RunProgram(int argc, char** argv, const ProgramInfo& info,
               const std::function<int()>& body);

// The same for a program with tables of settings of its own.
template <typename Settings>
int RunProgram(int argc, char** argv, ProgramInfo (*info)(Settings*),
               int (*body)(const Settings&, const ProgramInfo&)) {
  Settings settings;
  const ProgramInfo own = info(&settings);
  return RunProgram(argc, argv, own, [&] { return body(settings, own); });
}

// All flags of the program's groups as a file for --flagfile.
std::string FormatFlagFile(const ProgramInfo& info);

// Warns on stderr, a line each.
void Warn(const std::vector<std::string>& lines);

// Stops with kExitUsage and one line where a flag that must be given is empty.
// Throws UsageError, which RunProgram turns into that exit.
void RequireFlag(const std::string& name, const std::string& value);

// How many processor cores this process may use, at least 1.
int AvailableCores();

// What the flag --threads of a program comes to: 0 is one a core. Throws
// InputError for what is no number of threads.
int NumThreads(int flag);

}  // namespace rgbd_pose
