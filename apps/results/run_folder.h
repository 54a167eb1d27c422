#pragma once

#include <filesystem>
#include <string>

#include "core/util/locked_folder.h"

namespace rgbd_pose {

// The folder for the results of a run. Files are first written to a staging
// folder inside it and moved to their places together, so a failed run leaves
// earlier results unchanged: what is not published is removed. Two runs cannot
// use the folder at the same time.
class RunFolder {
 public:
  // Creates the folder. Throws InputError if it is in use or not writable.
  explicit RunFolder(const std::string& path);

  // The folder for files that are not yet published.
  const std::filesystem::path& staging_dir() const { return staging_.path(); }

  // Writes a file into the staging folder. Throws InputError.
  void WriteFile(const char* name, const std::string& content) const;

  // Moves all files to their places, metrics.json last, and removes those of an
  // earlier run, also in debug/, but no foreign files. Throws InputError.
  void Publish();

 private:
  const std::filesystem::path path_;
  const LockedFolder staging_;
};

}  // namespace rgbd_pose
