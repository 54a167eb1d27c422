#pragma once

#include <filesystem>
#include <string>

namespace rgbd_pose {

// The folder that a comparison leaves its files in.
class CompareOutput {
 public:
  explicit CompareOutput(const std::string& folder) : folder_(folder) {}

  // Makes the folder: whether results can be written is better known before
  // the work. Throws InputError.
  void Prepare() const;

  // The report is the last to be written and the first of an earlier one to
  // go: where it is, all is of one comparison.
  void Write(const std::string& file, const std::string& content) const;
  void WriteReport(const std::string& content) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace rgbd_pose
