#include "apps/batch/batch_list.h"

#include <glob.h>

#include <filesystem>
#include <map>

#include "core/geometry/camera.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

bool IsRecording(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) || path.extension() == ".bag" ||
         path.extension() == ".db3" || path.extension() == ".mcap";
}

// Returns the folders and bags that match a pattern, sorted. A path without
// wildcards matches itself.
std::vector<std::string> MatchingFolders(const std::string& pattern) {
  glob_t matches = {};
  std::vector<std::string> folders;
  if (glob(pattern.c_str(), 0, nullptr, &matches) == 0) {
    for (size_t i = 0; i < matches.gl_pathc; ++i) {
      if (IsRecording(matches.gl_pathv[i])) {
        folders.emplace_back(matches.gl_pathv[i]);
      }
    }
  }
  globfree(&matches);
  return folders;
}

// Names are used as folder names and as table cells.
bool IsUsableName(const std::string& name) {
  if (name.empty() || name[0] == '.') return false;
  for (const unsigned char c : name) {
    if (c < ' ' || c == ',' || c == '"' || c == '\\') return false;
  }
  return true;
}

class ListReader {
 public:
  explicit ListReader(const std::string& path)
      : path_(path), base_(fs::absolute(path).parent_path()) {}

  std::vector<BatchSequence> Read() {
    for (const TextLine& line : ReadTextTable(path_)) AddLine(line);
    if (sequences_.empty()) throw InputError(path_ + ": lists no sequences");
    return std::move(sequences_);
  }

 private:
  std::string FromBase(const std::string& path) const {
    return (base_ / path).lexically_normal().string();
  }

  void AddLine(const TextLine& line) {
    if (line.words.size() > 2) {
      throw InputError(path_, line.number,
                       "needs one or two columns (folder camera), has " +
                           std::to_string(line.words.size()));
    }
    const std::vector<std::string> folders =
        MatchingFolders(FromBase(line.words[0]));
    if (folders.empty()) {
      throw InputError(path_, line.number,
                       "no such folder: " + FromBase(line.words[0]));
    }
    for (const std::string& folder : folders) AddSequence(line, folder);
  }

  void AddSequence(const TextLine& line, const std::string& folder) {
    // "folder/" has an empty last component.
    const fs::path path = fs::path(folder + "/").parent_path();
    const std::string name = path.lexically_normal().filename().string();
    if (!IsUsableName(name)) {
      throw InputError(path_, line.number,
                       "'" + name +
                           "' is not a valid name (leading dot, comma, "
                           "quote or backslash); rename the folder or list a "
                           "link to it");
    }
    const auto [entry, is_new] = lines_.emplace(name, line.number);
    if (!is_new) {
      throw InputError(path_, line.number,
                       "sequence name '" + name + "' is already used in line " +
                           std::to_string(entry->second) +
                           "; rename the folder or list a link to it");
    }
    sequences_.push_back({name, path.string(), CameraOf(line, path)});
  }

  std::string CameraOf(const TextLine& line, const fs::path& folder) const {
    if (line.words.size() == 2 && CameraPreset(line.words[1])) {
      return line.words[1];
    }
    const bool given = line.words.size() == 2;
    std::string file =
        given ? FromBase(line.words[1]) : (folder / "camera.yaml").string();
    std::error_code error;
    // Other kinds of recordings contain the camera, or their run fails.
    const bool is_tum = fs::is_regular_file(folder / "rgb.txt", error);
    if (!given && !is_tum && !fs::is_regular_file(file, error)) return "";
    if (!fs::is_regular_file(file, error)) {
      throw InputError(path_, line.number,
                       "no camera: " + file +
                           " is not a file; give one in the second column, a "
                           "YAML file or one of " +
                           Join(CameraPresetNames()));
    }
    return file;
  }

  const std::string path_;
  const fs::path base_;
  std::map<std::string, int> lines_;  // by sequence name
  std::vector<BatchSequence> sequences_;
};

}  // namespace

std::vector<BatchSequence> ReadSequenceList(const std::string& path) {
  return ListReader(path).Read();
}

}  // namespace rgbd_pose
