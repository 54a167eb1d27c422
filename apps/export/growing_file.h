#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace rgbd_pose {

// A new file that grows during a run: under its TemporaryPath until it is
// complete. If the program is killed, what was written stays there.
class GrowingFile {
 public:
  // Throws InputError if the file cannot be created or exists, also under its
  // temporary path.
  explicit GrowingFile(const std::string& path);

  // Removes the file, unless it was published.
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  // Both throw InputError if writing fails (disk full). Then the file is
  // removed at once, so that others find space, and later calls fail, too.
  void Append(std::string_view bytes);
  // Call once, at the end: gives the complete file its name.
  void Publish();

 private:
  [[noreturn]] void Fail();
  void Remove();

  const std::string path_;
  std::FILE* file_ = nullptr;  // null: closed
  std::string failure_;        // why nothing more is written
  bool is_published_ = false;
};

}  // namespace rgbd_pose
