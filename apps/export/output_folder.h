#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace rgbd_pose {

// A folder that is written to a staging folder next to its place and moved
// there when complete.
class OutputFolder {
 public:
  // `entries` are the names of everything that will be in the folder. Throws
  // InputError if the folder cannot be created, or if a non-empty one exists
  // that must not be overwritten or holds other files.
  OutputFolder(const std::string& path, const std::set<std::string>& entries,
               bool overwrite);

  // Removes everything that was not published.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Creates a folder inside the staging folder and returns its current path.
  std::filesystem::path MakeFolder(const std::string& name) const;

  const std::filesystem::path& staging_dir() const { return staging_dir_; }

  // Moves the folder to its place.
  void Publish();

 private:
  std::filesystem::path path_;
  std::filesystem::path staging_dir_;
};

}  // namespace rgbd_pose
