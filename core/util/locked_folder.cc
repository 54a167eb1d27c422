#include "core/util/locked_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "core/util/input_error.h"
#include "core/util/open_file.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

std::mutex mutex;  // guards `folders`
std::set<const LockedFolder*> folders;

}  // namespace

LockedFolder::LockedFolder(fs::path path, const std::string& name,
                           const std::string& precious)
    : path_(std::move(path)), precious_(precious) {
  // From before the folder exists until it is among `folders`: RemoveAll, in
  // another thread, must not miss one that is just being created.
  const std::lock_guard lock(mutex);
  const auto fail = [&name](const std::error_code& error) {
    throw InputError(name + " cannot be created or written (" +
                     error.message() + ")");
  };
  std::error_code error;
  for (fs::path above = path_.parent_path();
       !above.empty() && !PathExists(above); above = above.parent_path()) {
    above_.push_back(above);
  }
  // The last user removes the folder when it ends. A program that opened it
  // just before must create and lock it again.
  do {
    if (lock_ >= 0) close(lock_);
    fs::create_directories(path_, error);
    if (error) fail(error);
    lock_ = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ < 0 && errno == ENOENT) continue;
    if (lock_ < 0) fail({errno, std::generic_category()});
    // File systems without locks are accepted.
    if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(lock_);
      throw InputError(name +
                       ": another program is writing its results here; wait "
                       "for it or choose another folder");
    }
  } while (!IsAt(lock_, path_));
  if (IsPrecious()) {
    close(lock_);
    throw InputError(name + " " + path_.string() +
                     " holds what a killed program has written; rename it to "
                     "keep it, or remove it");
  }
  for (const auto& entry : fs::directory_iterator(path_, error)) {
    fs::remove_all(entry, error);
  }
  folders.insert(this);
}

LockedFolder::~LockedFolder() {
  {
    const std::lock_guard lock(mutex);
    folders.erase(this);
  }
  Remove();
  close(lock_);
}

void LockedFolder::RemoveAll() {
  const std::lock_guard lock(mutex);
  for (const LockedFolder* const folder : folders) {
    if (!folder->IsPrecious()) folder->Remove();
  }
}

bool LockedFolder::IsPrecious() const {
  return !precious_.empty() && PathExists(path_ / precious_);
}

void LockedFolder::Remove() const {
  // Other threads may still write files: removed again.
  std::error_code error;
  for (int attempt = 0; attempt < 100 && IsAt(lock_, path_); ++attempt) {
    fs::remove_all(path_, error);
  }
  // Not those in which there is something by now, such as results.
  for (const fs::path& above : above_) fs::remove(above, error);
}

}  // namespace rgbd_pose
