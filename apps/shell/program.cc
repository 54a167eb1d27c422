#include "apps/shell/program.h"

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <system_error>

#include "apps/shell/flag_reader.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// A call without what the program needs.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

bool IsHelp(const std::string& argument) {
  return argument == "-h" || argument == "--h" || argument == "-help" ||
         argument == "--help" || argument == "--help=true" ||
         argument == "--helpfull" || argument == "--helpshort";
}

// gflags prints all 17 digits of a number.
std::string FlagValue(const gflags::CommandLineFlagInfo& flag,
                      const std::string& value) {
  return flag.type == "double"
             ? ShortNumber(std::strtod(value.c_str(), nullptr))
             : value;
}

void PrintHelp(const ProgramInfo& info) {
  std::printf("%s: %s\n\nExample:\n  %s\n", info.name.c_str(),
              info.summary.c_str(), info.example.c_str());
  for (const FlagGroup& group : info.flag_groups) {
    std::printf("\n%s:\n", group.title.c_str());
    for (const std::string& name : group.flags) {
      const auto flag = gflags::GetCommandLineFlagInfoOrDie(name.c_str());
      std::printf("  --%s (%s", name.c_str(), flag.type.c_str());
      if (!flag.default_value.empty()) {
        std::printf(", default %s",
                    FlagValue(flag, flag.default_value).c_str());
      }
      std::printf(")\n      %s\n", flag.description.c_str());
      const auto choices = info.choices.find(name);
      if (choices == info.choices.end()) continue;
      std::printf("      one of:");
      for (const std::string& choice : choices->second) {
        std::printf(" %s", choice.c_str());
      }
      std::printf("\n");
    }
  }
  std::printf(
      "\nAlso: --flagfile=FILE reads flags from a file, --help, --version.\n"
      "Exit codes: 0 ok, 1 usage, 2 bad input, 3 tracking failed, "
      "4 some batch items failed, 5 no better camera found,\n"
      "6 stopped early: results so far are kept.\n");
}

int Run(int argc, char** argv, const ProgramInfo& info,
        const std::function<int()>& body) {
  try {
    ReadFlags({argv + 1, argv + argc});
    FLAGS_logtostderr = true;
    google::InitGoogleLogging(argv[0]);
    // A file that grows beyond a limit is reported as a full disk is.
    std::signal(SIGXFSZ, SIG_IGN);
    const int exit_code = body();
    if (std::fflush(stdout) != 0) {
      throw InputError("the standard output cannot be written (" +
                       std::generic_category().message(errno) + ")");
    }
    return exit_code;
  } catch (const UsageError& error) {
    std::fprintf(stderr, "%s: %s\n", info.name.c_str(), error.what());
    return kExitUsage;
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s: %s\n", info.name.c_str(), error.what());
    return kExitBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: unexpected: %s\n", info.name.c_str(),
                 error.what());
    return kExitBadInput;
  }
}

}  // namespace

int RunProgram(int argc, char** argv, const ProgramInfo& info,
               const std::function<int()>& body) {
  for (int i = 1; i < argc; ++i) {
    if (IsHelp(argv[i])) {
      PrintHelp(info);
      return kExitOk;
    }
    if (std::string(argv[i]) == "--version") {
      std::printf("%s %s\n", info.name.c_str(), RGBD_POSE_VERSION);
      return kExitOk;
    }
  }
  return Run(argc, argv, info, body);
}

std::string FormatFlagFile(const ProgramInfo& info) {
  std::string text;
  for (const FlagGroup& group : info.flag_groups) {
    text += "# " + group.title + "\n";
    for (const std::string& name : group.flags) {
      const auto flag = gflags::GetCommandLineFlagInfoOrDie(name.c_str());
      text += "--" + name + "=" + FlagValue(flag, flag.current_value) + "\n";
    }
  }
  return text;
}

void Warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) LOG(WARNING) << line;
}

void RequireFlag(const std::string& name, const std::string& value) {
  if (value.empty()) {
    throw UsageError("--" + name + " is needed; see --help");
  }
}

}  // namespace rgbd_pose
