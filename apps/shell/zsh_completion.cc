#include "apps/shell/program_help.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// A description in the brackets of a specification that is in single quotes.
std::string Described(const std::string& text) {
  std::string quoted = "[";
  for (const char letter : text) {
    if (letter == '\'') {
      quoted += "'\\'";
    } else if (letter == '[' || letter == ']' || letter == '\\') {
      quoted += '\\';
    }
    quoted += letter;
  }
  return quoted + "]";
}

// What _arguments completes after "--name=".
std::string Value(const FlagHelp& flag) {
  if (flag.type != "string") return ":number: ";
  if (flag.choices.empty()) return ":text:_files";
  // Only the last name of lists such as a+b and a,b is completed.
  return ":name:{ compset -P \"*[+,]\"; compadd -- " + Join(flag.choices, " ") +
         " || _files }";
}

// The specification of a flag for _arguments.
std::string Specification(const FlagHelp& flag) {
  const std::string name = "'--" + flag.name;
  const std::string description = Described(flag.description);
  if (flag.type != "bool") {
    return name + "=" + description + Value(flag) + "'";
  }
  if (flag.default_value != "true") return name + description + "'";
  return name + description + "' \\\n  '--no" + flag.name +
         "[the opposite of --" + flag.name + "]'";
}

}  // namespace

std::string FormatZshCompletion(const ProgramHelp& help) {
  std::string text = "#compdef " + help.name +
                     "\n# Completion for zsh, printed by " + help.name +
                     " --help=zsh.\n_arguments \\\n";
  for (const FlagHelpGroup& group : help.groups) {
    for (const FlagHelp& flag : group.flags) {
      text += "  " + Specification(flag) + " \\\n";
    }
  }
  if (help.takes_recording) text += "  '1:recording:_files' \\\n";
  return text +
         "  '--flagfile=[reads flags from a file]:file:_files' \\\n"
         "  '--help[prints all flags]' \\\n"
         "  '--version[prints the version]'\n";
}

}  // namespace rgbd_pose
