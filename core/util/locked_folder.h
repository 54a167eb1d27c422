#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rgbd_pose {

// A folder for files that are not complete yet, which only one program uses.
class LockedFolder {
 public:
  // Creates the folder and those above it, or empties what a killed program
  // left of it. `name` begins the messages. Throws InputError if another
  // program uses the folder, if it cannot be created, and if it contains the
  // file `precious`, which marks what must not be lost (empty: nothing does).
  LockedFolder(std::filesystem::path path, const std::string& name,
               const std::string& precious = "");

  // Removes the folder, unless it has been moved, and those above it that were
  // created for it, if they are empty.
  ~LockedFolder();
  LockedFolder(const LockedFolder&) = delete;
  LockedFolder& operator=(const LockedFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Removes the folders of all objects there are, except those with their
  // precious file: for a program that ends at once. May be called from any
  // thread.
  static void RemoveAll();

 private:
  // Whether the folder contains the precious file.
  bool IsPrecious() const;
  void Remove() const;

  const std::filesystem::path path_;
  const std::string precious_;
  std::vector<std::filesystem::path> above_;  // that were created, from below
  int lock_ = -1;
};

}  // namespace rgbd_pose
