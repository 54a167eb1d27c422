#include "apps/compare/compare_output.h"

#include <system_error>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

constexpr char kReport[] = "report.md";

}  // namespace

void CompareOutput::Prepare() const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    throw InputError("--output=" + folder_.string() + ": cannot be made (" +
                     error.message() + ")");
  }
  RequireWritable((folder_ / kReport).string());
}

void CompareOutput::Write(const std::string& file,
                          const std::string& content) const {
  std::error_code ignored;
  std::filesystem::remove(folder_ / kReport, ignored);
  WriteFileAtomically((folder_ / file).string(), content);
}

void CompareOutput::WriteReport(const std::string& content) const {
  Write(kReport, content);
}

}  // namespace rgbd_pose
