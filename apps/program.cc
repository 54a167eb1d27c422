#include "apps/program.h"

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "core/input_error.h"
#include "core/text_file.h"

namespace rgbd_pose {
namespace {

constexpr char kVersion[] = "0.1.0";

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

void PrintHelp(const ProgramInfo& info) {
  std::printf("%s: %s\n\nExample:\n  %s\n", info.name.c_str(),
              info.summary.c_str(), info.example.c_str());
  for (const FlagGroup& group : info.flag_groups) {
    std::printf("\n%s:\n", group.title.c_str());
    for (const std::string& name : group.flags) {
      const auto flag = gflags::GetCommandLineFlagInfoOrDie(name.c_str());
      std::printf("  --%s (%s", name.c_str(), flag.type.c_str());
      if (!flag.default_value.empty()) {
        std::printf(", default %s", flag.default_value.c_str());
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
      "4 some batch items failed.\n");
}

// gflags leaves the process with code 1 at the first bad flag and lists every
// library's flags at --help; so look at the words before it does.
class FlagChecker {
 public:
  void Check(const std::vector<std::string>& words, const std::string& where) {
    for (size_t i = 0; i < words.size(); ++i) {
      const std::string& word = words[i];
      if (word == "--") return;
      if (word.size() < 2 || word[0] != '-') {
        throw InputError(where + "'" + word +
                         "' is no flag; flags look like --name=value");
      }
      const std::string text = word.substr(word[1] == '-' ? 2 : 1);
      const size_t equals = text.find('=');
      const std::string name = text.substr(0, equals);
      gflags::CommandLineFlagInfo flag;
      const bool known = gflags::GetCommandLineFlagInfo(name.c_str(), &flag);
      if (!known && equals == std::string::npos && IsNegatedBool(name)) {
        continue;
      }
      if (!known) {
        throw InputError(where + "unknown flag --" + name +
                         "; --help lists the flags");
      }
      std::string value = "true";
      if (equals != std::string::npos) {
        value = text.substr(equals + 1);
      } else if (flag.type != "bool") {
        if (++i == words.size()) {
          throw InputError(where + "--" + name + " needs a value");
        }
        value = words[i];
      }
      if (name == "flagfile") {
        CheckFile(value);
      } else if (gflags::SetCommandLineOption(name.c_str(), value.c_str())
                     .empty()) {
        throw InputError(where + "'" + value + "' is no " + flag.type +
                         " for --" + name);
      }
    }
  }

 private:
  static bool IsNegatedBool(const std::string& name) {
    gflags::CommandLineFlagInfo flag;
    return name.rfind("no", 0) == 0 &&
           gflags::GetCommandLineFlagInfo(name.substr(2).c_str(), &flag) &&
           flag.type == "bool";
  }

  void CheckFile(const std::string& path) {
    if (++depth_ > kMaxDepth) {
      throw InputError(path + ": flag files name each other in a circle");
    }
    const std::string content = ReadTextFile(path);
    size_t begin = 0;
    for (int number = 1; begin < content.size(); ++number) {
      const size_t end = std::min(content.find('\n', begin), content.size());
      std::string line = content.substr(begin, end - begin);
      begin = end + 1;
      while (!line.empty() && std::isspace(line.back())) line.pop_back();
      if (line.empty() || line[0] != '-') continue;  // as gflags reads it
      Check({line}, path + ":" + std::to_string(number) + ": ");
    }
    --depth_;
  }

  static constexpr int kMaxDepth = 8;
  int depth_ = 0;
};

int Run(int argc, char** argv, const ProgramInfo& info,
        const std::function<int()>& body) {
  try {
    FlagChecker().Check({argv + 1, argv + argc}, "");
    gflags::ParseCommandLineFlags(&argc, &argv, true);
    FLAGS_logtostderr = true;
    google::InitGoogleLogging(argv[0]);
    return body();
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
      std::printf("%s %s\n", info.name.c_str(), kVersion);
      return kExitOk;
    }
  }
  return Run(argc, argv, info, body);
}

std::string ProgramVersion() { return kVersion; }

std::string FormatFlagFile(const ProgramInfo& info) {
  std::string text;
  for (const FlagGroup& group : info.flag_groups) {
    text += "# " + group.title + "\n";
    for (const std::string& name : group.flags) {
      const auto flag = gflags::GetCommandLineFlagInfoOrDie(name.c_str());
      text += "--" + name + "=" + flag.current_value + "\n";
    }
  }
  return text;
}

void RequireFlag(const std::string& name, const std::string& value) {
  if (value.empty()) {
    throw UsageError("--" + name + " is needed; see --help");
  }
}

}  // namespace rgbd_pose
