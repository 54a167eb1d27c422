#include "frontend/sources/numbered_paths.h"

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <system_error>

#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// A name as patterns have it: old cameras and file systems write capitals, and
// some tools .jpeg for .jpg.
std::string UsualName(const std::string& file) {
  fs::path name = cv::toLowerCase(file);
  if (name.extension() == ".jpeg") name.replace_extension(".jpg");
  return name.string();
}

// The number in the place of * in a name; nothing if it differs elsewhere.
std::optional<int> NumberIn(const std::string& file,
                            const std::string& pattern) {
  const std::string name = UsualName(file);
  const size_t star = pattern.find('*');
  const size_t end = name.size() - (pattern.size() - star - 1);
  if (name.size() < pattern.size() ||
      name.compare(0, star, pattern, 0, star) != 0 ||
      name.compare(end, name.npos, pattern, star + 1) != 0) {
    return std::nullopt;
  }
  return ParseWhole(name.substr(star, end - star));
}

}  // namespace

std::map<int, std::string> NumberedPaths(
    const std::string& folder, const std::vector<std::string>& choices) {
  std::map<int, std::string> found;
  for (const std::string& choice : choices) {
    const fs::path pattern = choice;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(
             fs::path(folder) / pattern.parent_path(), error)) {
      const std::optional<int> number = NumberIn(
          entry.path().filename().string(), pattern.filename().string());
      if (!number.has_value()) continue;
      // Of names that differ in leading zeros or capitals the first by name.
      std::string& path = found[*number];
      const std::string next = entry.path().string();
      if (path.empty() || next < path) path = next;
    }
    if (!found.empty()) break;
  }
  return found;
}

}  // namespace rgbd_pose
