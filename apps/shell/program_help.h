#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

// What is said about a flag.
struct FlagHelp {
  std::string name;
  std::string type;  // of gflags: string, bool, int32, uint32, double
  std::string default_value;
  std::string description;
  std::vector<std::string> choices;  // valid names, if it takes names
};

struct FlagHelpGroup {
  std::string title;
  std::vector<FlagHelp> flags;
};

// What is said about a program; the same in each of the forms below.
struct ProgramHelp {
  std::string name;
  std::string summary;  // one sentence
  std::string example;  // one example call
  std::vector<FlagHelpGroup> groups;
  bool takes_recording = false;  // as the first word of a command
};

struct ExitCodeHelp {
  int code;
  const char* meaning;
};

// All exit codes, with their meaning.
const std::vector<ExitCodeHelp>& ExitCodesHelp();

// A form of help.
using HelpFormat = std::string (*)(const ProgramHelp&);

// What --help prints.
std::string FormatHelp(const ProgramHelp& help);

// The same as a manual page for man(1): --help=man.
std::string FormatManualPage(const ProgramHelp& help);

// Completion of flags, names and files in shells: --help=bash, --help=zsh.
std::string FormatBashCompletion(const ProgramHelp& help);
std::string FormatZshCompletion(const ProgramHelp& help);

}  // namespace rgbd_pose
