#include "frontend/sources/masks.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// Where the masks of the images in a folder may be.
std::array<fs::path, 2> MaskFolders(const fs::path& folder) {
  return {folder / "mask", folder / ".." / "mask"};
}

// The name of the mask of a colour image.
std::string MaskName(const fs::path& color) {
  return color.stem().string() + ".png";
}

}  // namespace

std::string MaskPath(const std::string& color_path) {
  const fs::path color(color_path);
  for (const fs::path& folder : MaskFolders(color.parent_path())) {
    const fs::path mask = folder / MaskName(color);
    if (IsFile(mask)) return mask.lexically_normal().string();
  }
  return "";
}

std::string MaskRemark(const std::vector<std::string>& color_paths) {
  if (color_paths.empty()) return "";
  const fs::path first(color_paths.front());
  for (const fs::path& folder : MaskFolders(first.parent_path())) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) continue;
    const bool has_any = std::any_of(
        color_paths.begin(), color_paths.end(),
        [](const std::string& path) { return !MaskPath(path).empty(); });
    if (has_any) return "";
    return folder.lexically_normal().string() +
           ": has no mask of a colour image, such as " + MaskName(first) +
           ", so nothing is left out";
  }
  return "";
}

}  // namespace rgbd_pose
