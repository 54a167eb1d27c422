// Where outputs may be.

#include <filesystem>
#include <system_error>

#include "apps/shell/program.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// The place that a path names, also if there is nothing yet. Made absolute
// first: otherwise the result for a name in this folder that is new is relative
// and cannot be compared.
std::filesystem::path PlaceOf(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  const fs::path place = fs::weakly_canonical(absolute, error);
  return ((error ? absolute.lexically_normal() : place) / "").parent_path();
}

// Whether a path is a folder or below it.
bool IsIn(const std::string& folder, const std::string& path) {
  const auto below = PlaceOf(path).lexically_relative(PlaceOf(folder));
  return !below.empty() && *below.begin() != "..";
}

}  // namespace

bool IsSamePlace(const std::string& path, const std::string& other) {
  return PlaceOf(path) == PlaceOf(other);
}

void RequireOtherFolder(const std::string& flag, const std::string& folder,
                        const std::string& other) {
  if (!IsIn(folder, other)) return;
  throw InputError("--" + flag + ": must be another folder than " + other +
                   ", and none that contains it");
}

void RequireOutside(const std::string& flag, const std::string& folder,
                    const std::string& recording, const std::string& name) {
  std::error_code error;
  if (!std::filesystem::is_directory(recording, error)) {
    if (!std::filesystem::equivalent(folder, recording, error)) return;
    throw InputError("--" + flag + "=" + folder + ": is the " + name +
                     " itself; choose another name");
  }
  if (!IsIn(recording, folder)) return;
  throw InputError("--" + flag + "=" + folder + ": is in the " + name +
                   "'s own folder " + recording + "; choose one outside it");
}

}  // namespace rgbd_pose
