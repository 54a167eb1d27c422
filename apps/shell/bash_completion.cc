#include "apps/shell/program_help.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// What the value of each flag is, as branches of a case statement.
std::string Branches(const ProgramHelp& help) {
  std::string branches;
  std::vector<std::string> files = {"--flagfile"};  // and other texts
  std::vector<std::string> numbers;
  for (const FlagHelpGroup& group : help.groups) {
    for (const FlagHelp& flag : group.flags) {
      const std::string name = "--" + flag.name;
      if (!flag.choices.empty()) {
        branches +=
            "    " + name + ") names=\"" + Join(flag.choices, " ") + "\" ;;\n";
      } else if (flag.type == "string") {
        files.push_back(name);
      } else if (flag.type != "bool") {
        numbers.push_back(name);
      }
    }
  }
  if (!numbers.empty()) {
    branches += "    " + Join(numbers, " | ") + ") return ;;\n";
  }
  return branches + "    " + Join(files, " | ") +
         ")\n      compopt -o default\n      return\n      ;;\n";
}

// "--name=" of flags with a value, "--name" and, if it is on, "--noname" of
// switches.
std::string FlagWords(const ProgramHelp& help) {
  std::string words = "--flagfile= --help --version";
  for (const FlagHelpGroup& group : help.groups) {
    for (const FlagHelp& flag : group.flags) {
      const bool is_switch = flag.type == "bool";
      words += " --" + flag.name + (is_switch ? "" : "=");
      if (is_switch && flag.default_value == "true") {
        words += " --no" + flag.name;
      }
    }
  }
  return words;
}

// With an empty COMPREPLY, -o default lets bash complete files.
constexpr char kReadWords[] = R"(
  local names="" word=${COMP_WORDS[COMP_CWORD]}
  local flag=${COMP_WORDS[COMP_CWORD - 1]}
  # bash splits --name=value into three words. Switches may have a value, too.
  if [[ $word == "=" ]]; then
    names="true false" word=""
  elif [[ $flag == "=" ]]; then
    names="true false" flag=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  COMPREPLY=()
)";

constexpr char kReply[] = R"(  esac
  if [[ -z $names ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$flags" -- "$word")
    [[ ${COMPREPLY[*]} != *= ]] || compopt -o nospace
    return
  fi
  # Only the last name of lists such as a+b and a,b is completed.
  local last=${word##*[+,]}
  mapfile -t COMPREPLY < <(
    compgen -P "${word%"$last"}" -W "$names" -- "$last")
  [[ ${#COMPREPLY[@]} -gt 0 ]] || compopt -o default
}
)";

}  // namespace

std::string FormatBashCompletion(const ProgramHelp& help) {
  const std::string function = "_" + help.name;
  const std::string recording =
      help.takes_recording
          ? "  if [[ $COMP_CWORD -eq 1 && $word != -* ]]; then\n"
            "    compopt -o default\n    return\n  fi\n"
          : "";
  return "# Completion for bash, printed by " + help.name + " --help=bash.\n" +
         function + "() {\n  local flags=\"" + FlagWords(help) + "\"" +
         kReadWords + recording + "  case $flag in\n" + Branches(help) +
         kReply + "complete -F " + function + " " + help.name + "\n";
}

}  // namespace rgbd_pose
