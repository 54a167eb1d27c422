#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace rgbd_pose {

// A folder that is written next to its place, and takes it when it is
// whole.
class OutputFolder {
 public:
  // `entries`: all that will be in it. Throws InputError if it cannot be made,
  // or there is one that is not empty and must not be overwritten or holds
  // other things.
  OutputFolder(const std::string& path, const std::set<std::string>& entries,
               bool overwrite);

  // Removes what has not been published.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Makes a folder in it; returns its path for now.
  std::filesystem::path MakeFolder(const std::string& name) const;

  // Where it is for now.
  const std::filesystem::path& staging_dir() const { return staging_dir_; }

  // Puts it in its place.
  void Publish();

 private:
  std::filesystem::path path_;
  std::filesystem::path staging_dir_;
};

}  // namespace rgbd_pose
