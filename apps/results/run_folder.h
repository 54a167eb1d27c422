#pragma once

#include <filesystem>
#include <string>

namespace rgbd_pose {

// The folder that a run leaves its results in. They are written first into a
// folder in it, and take their places together when all are written: a run that
// fails, whenever it does, leaves those of an earlier one as they were. Two
// runs at once are refused.
class RunFolder {
 public:
  // Makes the folder. Throws InputError if it cannot be written to or another
  // run works on it.
  explicit RunFolder(const std::string& path);

  // Removes what has not been published.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  // Where to write the results meanwhile.
  const std::filesystem::path& staging_dir() const { return staging_dir_; }

  // Writes a file into it. Throws InputError.
  void WriteFile(const char* name, const std::string& content) const;

  // Moves all files to their places, metrics.json last, and removes what an
  // earlier run has left of these or other results, images in debug/ included.
  // Files of others stay. Throws InputError.
  void Publish();

 private:
  void Lock();

  const std::filesystem::path path_;
  const std::filesystem::path staging_dir_;
  bool is_new_ = false;
  int lock_ = -1;
};

}  // namespace rgbd_pose
