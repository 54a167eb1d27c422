#include <map>

#include "apps/shell/program_help.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// Text as roff shows it unchanged: without care, it turns signs that people
// copy into typographic ones and takes lines with certain beginnings for
// requests.
std::string Roff(const std::string& text) {
  static const std::map<char, std::string> kSigns = {
      {'\\', "\\e"},  {'-', "\\-"},   {'\'', "\\(aq"},
      {'^', "\\(ha"}, {'~', "\\(ti"}, {'`', "\\(ga"}};
  std::string roff = !text.empty() && text[0] == '.' ? "\\&" : "";
  for (const char letter : text) {
    const auto sign = kSigns.find(letter);
    roff += sign == kSigns.end() ? std::string(1, letter) : sign->second;
  }
  return roff;
}

std::string Bold(const std::string& text) {
  return "\\fB" + Roff(text) + "\\fR";
}

std::string Italic(const std::string& text) {
  return "\\fI" + Roff(text) + "\\fR";
}

// A term of a list and its meaning.
std::string Item(const std::string& term, const std::string& meaning) {
  return ".TP\n" + term + "\n" + Roff(meaning) + "\n";
}

std::string FlagItem(const FlagHelp& flag) {
  const bool is_switch = flag.type == "bool";
  const std::string value = !flag.choices.empty()   ? "NAME"
                            : flag.type == "string" ? "TEXT"
                                                    : "NUMBER";
  std::string item =
      Item(is_switch ? Bold("--[no]" + flag.name)
                     : Bold("--" + flag.name + "=") + Italic(value),
           flag.description);
  if (!flag.choices.empty()) {
    item += ".br\nNames: " + Roff(Join(flag.choices)) + ".\n";
  }
  if (!flag.default_value.empty()) {
    item += ".br\nDefault: " + Roff(flag.default_value) + ".\n";
  }
  return item;
}

std::string OptionsOf(const ProgramHelp& help) {
  std::string text;
  for (const FlagHelpGroup& group : help.groups) {
    text += ".SS " + Roff(group.title) + "\n";
    for (const FlagHelp& flag : group.flags) text += FlagItem(flag);
  }
  return text + ".SS All programs\n" +
         Item(Bold("--flagfile=") + Italic("FILE"),
              "reads flags from a file with one flag per line; # begins a "
              "comment") +
         Item(Bold("--help"), "prints all flags") +
         Item(Bold("--help=") + Italic("FORM"),
              "man, bash or zsh: prints this page, or the completion for a "
              "shell") +
         Item(Bold("--version"), "prints the version");
}

std::string ExitCodes() {
  std::string text;
  for (const ExitCodeHelp& exit : ExitCodesHelp()) {
    text += Item(Bold(std::to_string(exit.code)), exit.meaning);
  }
  return text;
}

std::string OtherPrograms(const std::string& name) {
  std::vector<std::string> others;
  for (const std::string& program : SplitText(RGBD_POSE_PROGRAMS, ' ')) {
    if (program != name) others.push_back(Bold(program) + "(1)");
  }
  return Join(others, ",\n") + "\n";
}

}  // namespace

std::string FormatManualPage(const ProgramHelp& help) {
  std::string summary = help.summary;
  if (summary.back() == '.') summary.pop_back();
  std::string recording, about_recording;
  if (help.takes_recording) {
    recording = "[" + Italic("RECORDING") + "]\n";
    about_recording =
        Roff("A recording may be the first word, without --dataset=.") + "\n";
  }
  return ".TH " + help.name + " 1 " RGBD_POSE_DATE " \"rgbd_pose " +
         RGBD_POSE_VERSION + "\"\n.SH NAME\n" + help.name + " \\- " +
         Roff(summary) + "\n.SH SYNOPSIS\n" + Bold(help.name) + "\n" +
         recording + "[" + Bold("--") + Italic("FLAG") +
         "[=" + Italic("VALUE") + "]]...\n.SH DESCRIPTION\n" + Bold(help.name) +
         "\n" + Roff(summary) + ".\n" + about_recording +
         "The value of a flag may also be the next word.\n" +
         Roff("A switch is set by --name or --noname.") +
         "\nIf a flag is given twice, the last one counts.\n.SH OPTIONS\n" +
         OptionsOf(help) + ".SH EXIT STATUS\n" + ExitCodes() +
         ".SH EXAMPLES\n.nf\n" + Roff(help.example) + "\n.fi\n.SH SEE ALSO\n" +
         OtherPrograms(help.name);
}

}  // namespace rgbd_pose
