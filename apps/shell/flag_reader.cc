#include <gflags/gflags.h>

#include <set>
#include <vector>

#include "apps/shell/program.h"
#include "core/util/input_error.h"
#include "core/util/nearest_name.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

using gflags::CommandLineFlagInfo;

// Flags that gflags handles itself, partly by ending the process.
bool IsOfGflags(const std::string& name) {
  static const std::set<std::string> kNames = {
      "flagfile",    "fromenv",
      "tryfromenv",  "undefok",
      "help",        "helpfull",
      "helpmatch",   "helpon",
      "helppackage", "helpshort",
      "helpxml",     "tab_completion_columns",
      "version",     "tab_completion_word"};
  return kNames.count(name) > 0;
}

bool FindFlag(const std::string& name, CommandLineFlagInfo* flag) {
  return !IsOfGflags(name) &&
         gflags::GetCommandLineFlagInfo(name.c_str(), flag);
}

// Suggests the most similar flag, or what to do if there is none.
std::string Hint(const std::string& name) {
  std::vector<CommandLineFlagInfo> flags;
  gflags::GetAllFlags(&flags);
  std::vector<std::string> names;
  for (const CommandLineFlagInfo& flag : flags) {
    if (!IsOfGflags(flag.name)) names.push_back(flag.name);
  }
  const std::string nearest =
      NearestName(name, names, static_cast<int>(name.size()) / 3);
  return nearest.empty() ? "--help lists the flags"
                         : "did you mean --" + nearest + "?";
}

constexpr int kMaxNestedFiles = 8;
constexpr char kSpace[] = " \t\v\f\r";

void ReadFlagFile(const std::string& path, int depth);

// `where` is the prefix of error messages, `depth` the nesting of flag files.
void ReadWords(const std::vector<std::string>& words, const std::string& where,
               int depth) {
  for (auto word = words.begin(); word != words.end(); ++word) {
    // gflags would read a word only up to its first zero byte.
    if (word->size() < 2 || word->front() != '-' || *word == "--" ||
        word->find('\0') != std::string::npos) {
      const bool is_of_list = word != words.begin() && !(word - 1)->empty() &&
                              (word - 1)->back() == ',';
      throw InputError(where + "'" + *word + "' is not a flag; " +
                       (is_of_list ? "lists have no space after the comma"
                                   : "flags look like --name=value"));
    }
    const std::string text = word->substr((*word)[1] == '-' ? 2 : 1);
    const size_t equals = text.find('=');
    const bool has_value = equals != std::string::npos;
    const std::string name = text.substr(0, equals);
    CommandLineFlagInfo flag;
    std::string value;
    if (name != "flagfile" && !FindFlag(name, &flag)) {
      const bool is_off = !has_value && name.rfind("no", 0) == 0 &&
                          FindFlag(name.substr(2), &flag) &&
                          flag.type == "bool";
      if (!is_off) {
        throw InputError(where + "unknown flag --" + name + "; " + Hint(name));
      }
      value = "false";
    } else if (has_value) {
      value = text.substr(equals + 1);
    } else if (flag.type == "bool") {
      value = "true";
    } else if (++word != words.end()) {
      value = *word;
    } else {
      throw InputError(where + "--" + name + " needs a value");
    }
    value = WithHome(value);
    if (name == "flagfile") {
      ReadFlagFile(value, depth + 1);
    } else if (gflags::SetCommandLineOption(flag.name.c_str(), value.c_str())
                   .empty()) {
      throw InputError(where + "'" + value + "' is not a valid " + flag.type +
                       " for --" + flag.name);
    }
  }
}

void ReadFlagFile(const std::string& path, int depth) {
  if (depth > kMaxNestedFiles) {
    throw InputError(path + ": flag files include each other in a loop");
  }
  const std::string content = ReadTextFile(path);
  int number = 0;
  for (const std::string& line :
       SplitText(WithoutByteOrderMark(content), '\n')) {
    ++number;
    const size_t begin = line.find_first_not_of(kSpace);
    if (begin == std::string::npos || line[begin] == '#') continue;
    const size_t end = line.find_last_not_of(kSpace) + 1;
    ReadWords({line.substr(begin, end - begin)},
              path + ":" + std::to_string(number) + ": ", depth);
  }
}

}  // namespace

void ReadFlags(const std::vector<std::string>& words) {
  ReadWords(words, "", 0);
}

}  // namespace rgbd_pose
