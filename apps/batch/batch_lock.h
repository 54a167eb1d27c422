#pragma once

#include <string>

#include "apps/batch/batch_shard.h"

namespace rgbd_pose {

// Keeps an output folder for this process: a whole batch alone, shards next to
// each other but each shard once. Held until the process and all processes
// that it has started have ended, however they end, since those inherit the
// open files: a run that outlives a killed batch for a moment never writes
// next to its successor.
class BatchLock {
 public:
  // Throws InputError if another process works on the folder.
  BatchLock(const std::string& output, const BatchShard& shard);
  ~BatchLock();
  BatchLock(const BatchLock&) = delete;
  BatchLock& operator=(const BatchLock&) = delete;

 private:
  int folder_file_ = -1;
  int shard_file_ = -1;  // -1 for a whole batch
};

}  // namespace rgbd_pose
