#include "apps/batch/batch_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// The kernel needs a moment to end the runs of a batch that was killed.
constexpr auto kPatience = std::chrono::seconds(1);
constexpr auto kRetryEvery = std::chrono::milliseconds(20);

// Opens and locks a file; `kind` is LOCK_EX (alone) or LOCK_SH (with others).
int Lock(const std::string& path, int kind) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT, 0666);
  if (file < 0) {
    throw InputError(path + ": cannot be opened (" + std::strerror(errno) +
                     ")");
  }
  const auto start = std::chrono::steady_clock::now();
  while (flock(file, kind | LOCK_NB) != 0) {
    const int error = errno;
    if (error == EINTR) continue;
    if (error == EWOULDBLOCK &&
        std::chrono::steady_clock::now() - start < kPatience) {
      std::this_thread::sleep_for(kRetryEvery);
      continue;
    }
    close(file);
    if (error != EWOULDBLOCK) {
      throw InputError(path + ": cannot be locked (" + std::strerror(error) +
                       ")");
    }
    throw InputError(path +
                     ": held by another rgbd_batch that works on this folder; "
                     "wait for it or choose another --output");
  }
  return file;
}

}  // namespace

BatchLock::BatchLock(const std::string& output, const BatchShard& shard)
    : folder_file_(
          Lock(output + "/.lock", shard.IsWhole() ? LOCK_EX : LOCK_SH)) {
  if (shard.IsWhole()) return;
  try {
    shard_file_ = Lock(output + "/.lock-" + shard.Name(), LOCK_EX);
  } catch (const InputError&) {
    close(folder_file_);
    throw;
  }
}

BatchLock::~BatchLock() {
  if (shard_file_ >= 0) close(shard_file_);
  close(folder_file_);
}

}  // namespace rgbd_pose
