#include "apps/export/growing_file.h"

#include <cerrno>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {

GrowingFile::GrowingFile(const std::string& path) : path_(path) {
  if (PathExists(path)) {
    throw InputError(path + ": exists; choose another name, or remove it");
  }
  const std::string temporary = TemporaryPath(path);
  file_ = std::fopen(temporary.c_str(), "wbx");  // x: only if it is new
  if (file_ != nullptr) return;
  if (errno == EEXIST) {
    throw InputError(temporary +
                     ": another program is writing it, or a killed one has "
                     "left it; rename it to keep it, or remove it");
  }
  throw InputError(path + ": cannot be written " + LastFailure() +
                   "; check that its folder exists and is writable");
}

GrowingFile::~GrowingFile() {
  if (!is_published_ && failure_.empty()) Remove();
}

void GrowingFile::Append(std::string_view bytes) {
  if (file_ == nullptr ||
      std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size() ||
      std::fflush(file_) != 0) {
    Fail();
  }
}

void GrowingFile::Publish() {
  if (file_ == nullptr) Fail();
  const bool is_closed = std::fclose(file_) == 0;
  file_ = nullptr;
  if (!is_closed) Fail();
  if (std::rename(TemporaryPath(path_).c_str(), path_.c_str()) != 0) Fail();
  is_published_ = true;
}

void GrowingFile::Fail() {
  if (failure_.empty()) {
    failure_ = path_ + ": writing failed " + LastFailure();
  }
  Remove();
  throw InputError(failure_);
}

void GrowingFile::Remove() {
  if (file_ != nullptr) std::fclose(file_);
  file_ = nullptr;
  std::remove(TemporaryPath(path_).c_str());
}

}  // namespace rgbd_pose
