#include <system_error>

#include "apps/export/export_format.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void FailToWrite(const fs::path& path,
                              const std::error_code& error) {
  throw InputError("--output: " + path.string() + " cannot be created (" +
                   error.message() + ")");
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path,
                           const std::set<std::string>& entries, bool overwrite)
    : path_(fs::absolute(path).lexically_normal()) {
  if (!path_.has_filename()) path_ = path_.parent_path();
  staging_dir_ = path_.string() + ".partial";
  std::error_code error;
  if (fs::exists(path_) && !fs::is_directory(path_)) {
    throw InputError("--output: " + path + " is a file; a folder is needed");
  }
  if (!overwrite && fs::is_directory(path_) && !fs::is_empty(path_)) {
    throw InputError("--output: " + path +
                     " is not empty; use --overwrite to replace it");
  }
  for (const auto& entry : fs::directory_iterator(path_, error)) {
    const std::string name = entry.path().filename();
    if (entries.count(name) == 0) {
      throw InputError("--output: " + path + " contains other files, such as " +
                       name + "; choose another folder");
    }
  }
  fs::remove_all(staging_dir_, error);  // left by a killed export
  fs::create_directories(staging_dir_, error);
  if (error) FailToWrite(path, error);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(staging_dir_, ignored);
}

fs::path OutputFolder::MakeFolder(const std::string& name) const {
  std::error_code error;
  fs::create_directories(staging_dir_ / name, error);
  if (error) FailToWrite(staging_dir_ / name, error);
  return staging_dir_ / name;
}

void OutputFolder::Publish() {
  std::error_code error;
  fs::remove_all(path_, error);
  fs::rename(staging_dir_, path_, error);
  if (error) FailToWrite(path_, error);
}

}  // namespace rgbd_pose
