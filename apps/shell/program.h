#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/util/setting.h"

namespace rgbd_pose {

// Exit codes of all programs of the project.
enum ExitCode {
  kExitOk = 0,
  kExitUsage = 1,           // a required flag is missing
  kExitBadInput = 2,        // an unusable flag, file or image
  kExitTrackingFailed = 3,  // finished, but the result is not usable
  kExitSomeFailed = 4,      // some items of a batch failed
  kExitCameraKept = 5,      // no better camera was found
  kExitStopped = 6,         // by a signal, or no frame could be read
};

// Flags that are shown together in --help.
struct FlagGroup {
  std::string title;
  std::vector<std::string> flags;
};

// The information that --help shows about a program.
struct ProgramInfo {
  std::string name;
  std::string summary;  // one sentence
  std::string example;  // one example call
  std::vector<FlagGroup> flag_groups;
  // Tables of settings whose rows become flags, shown before the groups above.
  // The settings must live as long as the program.
  std::vector<std::vector<Setting>> settings = {};
  // Flags of the groups whose value is one of a list of names.
  std::map<std::string, std::vector<std::string>> choices = {};
  // Whether --output, if it is not given, is runs/NAME, with the recording's
  // name and, if that exists, a number.
  bool has_default_output = false;
};

// Runs a program: handles --help and --version, reads the flags into the
// settings, initialises logging to stderr and calls `body`. A first word that
// is no flag is the value of --dataset. A bad flag or an InputError of `body`
// becomes one line on stderr and exit code 2.
int RunProgram(int argc, char** argv, const ProgramInfo& info,
               const std::function<int()>& body);

// The same for a program with its own tables of settings.
template <typename Settings>
int RunProgram(int argc, char** argv, ProgramInfo (*info)(Settings*),
               int (*body)(const Settings&, const ProgramInfo&)) {
  Settings settings;
  const ProgramInfo own = info(&settings);
  return RunProgram(argc, argv, own, [&] { return body(settings, own); });
}

// Sets gflags from words such as "--name=value", "--name value", "--switch" and
// "--noswitch", and from files named by --flagfile. These have one flag per
// line, "#" starts a comment, and CRLF and a byte order mark are accepted. (The
// parser of gflags is not used: it ends the process at the first bad flag and
// accepts flags of its own that list the flags of every library.) The last
// value counts. Throws InputError for an unknown flag, a value of the wrong
// type or a word that is not a flag.
void ReadFlags(const std::vector<std::string>& words);

// Formats all flags of the program's groups as a file for --flagfile.
std::string FormatFlagFile(const ProgramInfo& info);

// The time that has passed since `start`, s.
double SecondsSince(std::chrono::steady_clock::time_point start);

// Prints warnings on stderr, one per line; empty ones are skipped.
void Warn(const std::vector<std::string>& lines);

// Ends RunProgram with one line on stderr and kExitUsage if the value is empty.
void RequireFlag(const std::string& name, const std::string& value);

// The text with the user's home folder for each "~" that begins a path, alone
// or in a list: shells leave it as it is in --flag=~/path. Throws InputError if
// there is no home folder.
std::string WithHome(const std::string& text);

// Throws InputError if the folder or file of a flag is a recording or below it:
// it would replace files of the recording, or be taken for one of them.
void RequireOutside(const std::string& flag, const std::string& folder,
                    const std::string& recording,
                    const std::string& name = "recording");

// Whether two paths name the same file or folder, also if there is none yet.
bool IsSamePlace(const std::string& path, const std::string& other);

// Throws InputError if the folder of a flag is `other` or contains it: their
// files would be replaced or mixed.
void RequireOtherFolder(const std::string& flag, const std::string& folder,
                        const std::string& other);

// This is more threads than any machine could use here.
inline constexpr int kMaxThreads = 256;

// The number of processor cores that this process may use, at least 1.
int AvailableCores();

// The number of threads for --threads; 0: one per core. Throws InputError.
int NumThreads(int flag);

}  // namespace rgbd_pose
