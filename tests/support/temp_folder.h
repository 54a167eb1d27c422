#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "core/util/text_file.h"

namespace rgbd_pose {

// A folder for one test, removed afterwards. It is named after the test and its
// process, since tests, and checkouts, may run at the same time.
class TempFolder {
 public:
  TempFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name =
        std::string(test->test_suite_name()) + "." + test->name();
    for (char& c : name) {
      if (c == '/') c = '_';
    }
    name = "rgbd_pose." + name + "." + std::to_string(getpid());
    path_ = std::filesystem::path(testing::TempDir()) / name;
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::string path() const { return path_.string(); }

  // The path of a file in the folder.
  std::string operator/(const std::string& name) const {
    return (path_ / name).string();
  }

  // Writes a file (and the folders above it) and returns its path.
  std::string Write(const std::string& name, const std::string& text) const {
    const std::string file = *this / name;
    std::filesystem::create_directories(
        std::filesystem::path(file).parent_path());
    WriteFileAtomically(file, text);
    return file;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace rgbd_pose
