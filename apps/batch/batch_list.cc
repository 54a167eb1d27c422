#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <string_view>

#include "apps/batch/batch_plan.h"
#include "apps/shell/program.h"
#include "core/geometry/camera.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/bags/bag_reader.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// The folders and bags that match a pattern, sorted.
std::vector<std::string> MatchingFolders(const std::string& pattern) {
  glob_t matches = {};
  std::vector<std::string> folders;
  if (glob(pattern.c_str(), 0, nullptr, &matches) == 0) {
    for (size_t i = 0; i < matches.gl_pathc; ++i) {
      const std::string path = matches.gl_pathv[i];
      std::error_code error;
      if (fs::is_directory(path, error) || IsBag(path, BagKind::kRos1) ||
          IsBag(path, BagKind::kRos2)) {
        folders.push_back(path);
      }
    }
  }
  globfree(&matches);
  return folders;
}

// Names are used as folder names and as table cells.
bool IsUsableName(const std::string& name) {
  return !name.empty() && name[0] != '.' &&
         std::none_of(name.begin(), name.end(), [](unsigned char c) {
           return c < ' ' || c == ',' || c == '"' || c == '\\';
         });
}

// The camera of a recording: `named`, or that in its folder if this is empty.
// `place` (file:line) is put before an error.
std::string CameraOf(const fs::path& folder, const std::string& named,
                     const fs::path& base, const std::string& place) {
  if (CameraPreset(named)) return named;
  const fs::path file = named.empty() ? folder / "camera.yaml"
                                      : (base / named).lexically_normal();
  if (IsFile(file)) return file.string();
  // Other kinds of recordings contain the camera, or their run fails.
  if (named.empty() &&
      (!IsFile(folder / "rgb.txt") || IsFile(folder / "calibration.txt"))) {
    return "";
  }
  throw InputError(place + "no camera: " + file.string() +
                   " is not a file; give one in the second column, a YAML "
                   "file or one of " +
                   Join(CameraPresetNames()));
}

// The words of a line up to a comment, between spaces, tabs or commas. Those in
// double quotes may contain these. `place` (file:line) is put before an error.
std::vector<std::string> WordsOf(std::string_view line,
                                 const std::string& place) {
  constexpr std::string_view kSeparators = " \t,\r";
  std::vector<std::string> words;
  while (true) {
    line.remove_prefix(
        std::min(line.find_first_not_of(kSeparators), line.size()));
    if (line.empty() || line[0] == '#') return words;
    const bool is_quoted = line[0] == '"';
    if (is_quoted) line.remove_prefix(1);
    const size_t end = line.find_first_of(is_quoted ? "\"" : " \t,\r#");
    if (is_quoted && end == std::string_view::npos) {
      throw InputError(place + "a quotation mark is not closed");
    }
    words.emplace_back(line.substr(0, end));
    line.remove_prefix(std::min(end, line.size()));
    if (is_quoted) line.remove_prefix(1);
  }
}

}  // namespace

std::vector<BatchSequence> ReadSequenceList(const std::string& path) {
  const fs::path base = fs::absolute(path).parent_path();
  const std::string literal = std::regex_replace(
      (base / "").string(), std::regex(R"([*?[\\])"), R"(\$&)");
  std::vector<BatchSequence> sequences;
  std::map<std::string, int> lines;  // by sequence name
  const std::string text = ReadTextFile(path);
  int number = 0;
  for (const std::string& line : SplitText(WithoutByteOrderMark(text), '\n')) {
    const std::string place = path + ":" + std::to_string(++number) + ": ";
    const std::vector<std::string> words = WordsOf(line, place);
    if (words.empty()) continue;
    if (words.size() > 2) {
      throw InputError(place +
                       "needs one or two columns (folder camera), has " +
                       std::to_string(words.size()) +
                       "; put a path with spaces in quotation marks");
    }
    const std::string listed = WithHome(words[0]);
    const std::string camera = words.size() == 2 ? WithHome(words[1]) : "";
    const std::string pattern =
        fs::path(listed).is_absolute() ? listed : literal + listed;
    const std::vector<std::string> folders = MatchingFolders(pattern);
    if (folders.empty()) throw InputError(place + "no such folder: " + listed);
    for (const std::string& match : folders) {
      // "folder/" has an empty last component.
      const fs::path folder =
          fs::path(match + "/").lexically_normal().parent_path();
      const std::string name = folder.filename().string();
      if (!IsUsableName(name)) {
        throw InputError(place + "'" + name +
                         "' is not a valid name (leading dot, comma, "
                         "quote or backslash); rename the folder or list a "
                         "link to it");
      }
      const auto [entry, is_new] = lines.emplace(name, number);
      if (!is_new) {
        throw InputError(place + "sequence name '" + name +
                         "' is already used in line " +
                         std::to_string(entry->second) +
                         "; rename the folder or list a link to it");
      }
      sequences.push_back(
          {name, folder.string(), CameraOf(folder, camera, base, place)});
    }
  }
  if (sequences.empty()) throw InputError(path + ": lists no sequences");
  return sequences;
}

}  // namespace rgbd_pose
