#include "apps/shell/program.h"

#include <fcntl.h>
#include <gflags/gflags.h>
#include <glog/logging.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <exception>
#include <filesystem>
#include <map>
#include <new>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "apps/shell/program_help.h"
#include "apps/shell/stop_signal.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// The error of a call without a required flag.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Defines a gflag for each row of some tables of settings, while it lives.
class SettingFlags {
 public:
  explicit SettingFlags(const std::vector<std::vector<Setting>>& tables) {
    for (const std::vector<Setting>& table : tables) {
      for (const Setting& setting : table) {
        std::visit([&](const auto& value) { Add(setting, value); },
                   setting.value);
      }
    }
  }

  // Sets values by name; gflags writes numbers and texts into the settings
  // itself. Throws InputError for unknown names.
  void Apply() const {
    for (const auto& [named, text] : texts_) named.set(text);
  }

 private:
  void Add(const Setting& setting, const NamedSetting& named) {
    texts_.emplace_back(named, named.get());
    Add(setting, &texts_.back().second);
  }

  // gflags keeps the addresses of both values.
  template <typename Value>
  void Add(const Setting& setting, Value* current) {
    defaults_.emplace_back(*current);
    gflags::FlagRegisterer(setting.name, setting.help, __FILE__, current,
                           &std::get<Value>(defaults_.back()));
  }

  // Deques keep the addresses of their elements.
  std::deque<std::pair<NamedSetting, std::string>> texts_;
  std::deque<std::variant<int, uint32_t, double, bool, std::string>> defaults_;
};

// Shortens numbers: gflags prints all 17 digits.
std::string FlagValue(const gflags::CommandLineFlagInfo& flag,
                      const std::string& value) {
  if (flag.type != "double") return value;
  return ShortNumber(std::strtod(value.c_str(), nullptr));
}

// The groups of the settings, then the program's own groups.
std::vector<FlagGroup> AllGroups(const ProgramInfo& info) {
  std::vector<FlagGroup> groups;
  for (const std::vector<Setting>& table : info.settings) {
    for (const Setting& setting : table) {
      if (groups.empty() || groups.back().title != setting.group) {
        groups.push_back({std::string(setting.group), {}});
      }
      groups.back().flags.push_back(setting.name);
    }
  }
  groups.insert(groups.end(), info.flag_groups.begin(), info.flag_groups.end());
  return groups;
}

// The valid names of a flag; empty if it does not take a name.
std::vector<std::string> ChoicesOf(const ProgramInfo& info,
                                   const std::string& flag) {
  for (const std::vector<Setting>& table : info.settings) {
    if (const Setting* row = FindNamed(table, flag)) return row->choices;
  }
  const auto choices = info.choices.find(flag);
  return choices == info.choices.end() ? std::vector<std::string>()
                                       : choices->second;
}

// What the tables say about the program.
ProgramHelp HelpOf(const ProgramInfo& info) {
  ProgramHelp help = {info.name, info.summary, info.example, {}};
  for (const FlagGroup& group : AllGroups(info)) {
    help.groups.push_back({group.title, {}});
    for (const std::string& name : group.flags) {
      const auto flag = gflags::GetCommandLineFlagInfoOrDie(name.c_str());
      help.groups.back().flags.push_back(
          {name, flag.type, FlagValue(flag, flag.default_value),
           flag.description, ChoicesOf(info, name)});
    }
  }
  gflags::CommandLineFlagInfo flag;
  help.takes_recording = gflags::GetCommandLineFlagInfo("dataset", &flag);
  return help;
}

// The form of help that an argument asks for; nullptr if it asks for none.
HelpFormat HelpFormatOf(const std::string& argument) {
  static const std::map<std::string, HelpFormat> kForms = {
      {"-h", FormatHelp},
      {"--h", FormatHelp},
      {"-help", FormatHelp},
      {"--help", FormatHelp},
      {"--help=true", FormatHelp},
      {"--helpfull", FormatHelp},
      {"--helpshort", FormatHelp},
      {"--help=man", FormatManualPage},
      {"--help=bash", FormatBashCompletion},
      {"--help=zsh", FormatZshCompletion}};
  const auto form = kForms.find(argument);
  return form == kForms.end() ? nullptr : form->second;
}

// The words of the command line. If a recording begins them, it becomes
// --dataset.
std::vector<std::string> Words(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  gflags::CommandLineFlagInfo flag;
  const bool is_recording = !words.empty() && !words[0].empty() &&
                            words[0][0] != '-' &&
                            gflags::GetCommandLineFlagInfo("dataset", &flag);
  if (is_recording) words[0].insert(0, "--dataset=");
  return words;
}

// "runs/NAME" or the first of runs/NAME-2, runs/NAME-3, ... that is not there.
std::string NewOutput(const std::string& dataset) {
  namespace fs = std::filesystem;
  fs::path recording = fs::absolute(dataset).lexically_normal();
  if (!recording.has_filename()) recording = recording.parent_path();
  std::error_code error;
  const fs::path name = fs::is_directory(recording, error)
                            ? recording.filename()
                            : recording.stem();
  const std::string first = (fs::path("runs") / name).string();
  std::string output = first;
  for (int i = 2; PathExists(output); ++i) {
    output = first + "-" + std::to_string(i);
  }
  return output;
}

void SetDefaultOutput() {
  std::string dataset, output;
  gflags::GetCommandLineOption("dataset", &dataset);
  gflags::GetCommandLineOption("output", &output);
  if (dataset.empty() || !output.empty()) return;
  gflags::SetCommandLineOption("output", NewOutput(dataset).c_str());
}

// Fills the places of standard streams that the caller has closed: a file that
// is opened later would get their number, and what is printed. Printing still
// fails.
void FillClosedStreams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

// Prints the help or the version, if an argument asks for it. Returns whether
// one does.
bool PrintHelp(int argc, char** argv, const ProgramInfo& info) {
  for (int i = 1; i < argc; ++i) {
    if (const HelpFormat format = HelpFormatOf(argv[i])) {
      std::fputs(format(HelpOf(info)).c_str(), stdout);
      return true;
    }
    if (std::string(argv[i]) == "--version") {
      std::printf("%s %s\n", info.name.c_str(), RGBD_POSE_VERSION);
      return true;
    }
  }
  return false;
}

// Throws InputError if what was printed cannot be written.
void FinishOutput() {
  const bool is_written = std::fflush(stdout) == 0;
  if (is_written && std::ferror(stdout) == 0) return;
  throw InputError("the standard output cannot be written (" +
                   std::generic_category().message(is_written ? EIO : errno) +
                   ")");
}

// OpenCV has an error of its own for it.
bool IsOutOfMemory(const std::exception& error) {
  const auto* of_opencv = dynamic_cast<const cv::Exception*>(&error);
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
         (of_opencv != nullptr && of_opencv->code == cv::Error::StsNoMem);
}

}  // namespace

int RunProgram(int argc, char** argv, const ProgramInfo& info,
               const std::function<int()>& body) {
  FillClosedStreams();
  const SettingFlags settings(info.settings);
  try {
    if (PrintHelp(argc, argv, info)) {
      FinishOutput();
      return kExitOk;
    }
    ReadFlags(Words(argc, argv));
    if (info.has_default_output) SetDefaultOutput();
    FLAGS_logtostderr = true;
    google::InitGoogleLogging(argv[0]);
    // This signal is ignored, so that exceeding a file size limit is reported
    // like a full disk.
    std::signal(SIGXFSZ, SIG_IGN);
    // Programs have threads of their own; OpenCV's would compete with them.
    cv::setNumThreads(1);
    settings.Apply();
    const CleanEnd clean_end;
    const int exit_code = body();
    FinishOutput();
    return exit_code;
  } catch (const UsageError& error) {
    std::fprintf(stderr, "%s: %s\n", info.name.c_str(), error.what());
    return kExitUsage;
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s: %s\n", info.name.c_str(), error.what());
    return kExitBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    std::fprintf(stderr, "%s: %s: %s; check the path and permissions\n",
                 info.name.c_str(), error.path1().c_str(),
                 error.code().message().c_str());
    return kExitBadInput;
  } catch (const std::exception& error) {
    const std::string what =
        IsOutOfMemory(error)
            ? "there is not enough memory; use larger voxels, fewer or smaller "
              "images, fewer threads, or give the program more"
            : std::string("unexpected: ") + error.what();
    std::fprintf(stderr, "%s: %s\n", info.name.c_str(), what.c_str());
    return kExitBadInput;
  }
}

std::string FormatFlagFile(const ProgramInfo& info) {
  std::string text;
  for (const FlagGroup& group : AllGroups(info)) {
    text += "# " + group.title + "\n";
    for (const std::string& name : group.flags) {
      const auto flag = gflags::GetCommandLineFlagInfoOrDie(name.c_str());
      text += "--" + name + "=" + FlagValue(flag, flag.current_value) + "\n";
    }
  }
  return text;
}

double SecondsSince(std::chrono::steady_clock::time_point start) {
  const auto passed = std::chrono::steady_clock::now() - start;
  return std::chrono::duration<double>(passed).count();
}

void Warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    if (!line.empty()) LOG(WARNING) << line;
  }
}

void RequireFlag(const std::string& name, const std::string& value) {
  if (value.empty()) throw UsageError("--" + name + " is needed; see --help");
}

std::string WithHome(const std::string& text) {
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool begins = i == 0 || text[i - 1] == ',';
    const char next = i + 1 < text.size() ? text[i + 1] : '/';
    if (!begins || text[i] != '~' || (next != '/' && next != ',')) {
      result += text[i];
      continue;
    }
    const char* const home = std::getenv("HOME");
    if (home == nullptr || *home == '\0') {
      throw InputError("'" + text + "': there is no home folder (HOME)");
    }
    result += home;
  }
  return result;
}

int AvailableCores() {
  // Unlike the number of all cores, this respects the limit of a scheduler.
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof(cores), &cores) == 0) {
    return std::max(1, CPU_COUNT(&cores));
  }
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int NumThreads(int flag) {
  if (flag < 0 || flag > kMaxThreads) {
    throw InputError("--threads must be 0 (one per core) to " +
                     std::to_string(kMaxThreads));
  }
  return flag > 0 ? flag : std::min(AvailableCores(), kMaxThreads);
}

}  // namespace rgbd_pose
