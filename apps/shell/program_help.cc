#include "apps/shell/program_help.h"

#include "apps/shell/program.h"
#include "core/util/text_file.h"

namespace rgbd_pose {

const std::vector<ExitCodeHelp>& ExitCodesHelp() {
  static const std::vector<ExitCodeHelp> kCodes = {
      {kExitOk, "ok"},
      {kExitUsage, "a needed flag is missing"},
      {kExitBadInput, "bad flags or input"},
      {kExitTrackingFailed, "tracking failed"},
      {kExitSomeFailed, "some runs of a batch failed"},
      {kExitCameraKept, "no better camera was found"},
      {kExitStopped, "stopped early with the results so far"}};
  return kCodes;
}

std::string FormatHelp(const ProgramHelp& help) {
  std::string text = help.name + ": " + help.summary + "\n\nExample:\n  " +
                     help.example + "\n";
  for (const FlagHelpGroup& group : help.groups) {
    text += "\n" + group.title + ":\n";
    for (const FlagHelp& flag : group.flags) {
      text += "  --" + flag.name + " (" + flag.type;
      if (!flag.default_value.empty())
        text += ", default " + flag.default_value;
      text += ")\n      " + flag.description + "\n";
      if (flag.choices.empty()) continue;
      text += "      one of: " + Join(flag.choices, " ") + "\n";
    }
  }
  if (help.takes_recording) {
    text += "\nA recording may be the first word, without --dataset=.\n";
  }
  std::vector<std::string> codes;
  for (const ExitCodeHelp& exit : ExitCodesHelp()) {
    codes.push_back(std::to_string(exit.code) + " " + exit.meaning);
  }
  return text +
         "\nAlso: --flagfile=FILE reads flags from a file, --help, --version.\n"
         "--help=man prints a manual page, --help=bash and --help=zsh what "
         "completes flags in these shells.\nExit codes: " +
         Join(codes) + ".\n";
}

}  // namespace rgbd_pose
