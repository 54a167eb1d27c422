#pragma once

#include <optional>
#include <string>

#include "apps/batch/batch_plan.h"

namespace rgbd_pose {

// The end of a run, as recorded in its done.json.
struct RunEnd {
  std::string status;  // ok, failed, timeout or crashed
  int exit_code = 0;   // of the program; 128 + signal if killed
  std::string hash;    // of the run (BatchRun::hash)
};

// The run folders of one batch. A run works in "<name>.partial", which is
// renamed to "<name>" in one step when it has ended: "<name>" is complete.
// All functions throw InputError if a folder or file cannot be written.
class BatchFolder {
 public:
  explicit BatchFolder(std::string output) : output_(std::move(output)) {}

  const std::string& output() const { return output_; }
  std::string Complete(const BatchRun& run) const;
  std::string Partial(const BatchRun& run) const;

  // How a run has ended; empty if it has not, or if its hash differs.
  std::optional<RunEnd> ReadEnd(const BatchRun& run) const;

  // Whether the run has ended, with any hash.
  bool Holds(const BatchRun& run) const;

  // The first run folder of a sequence (of any sequence if the name is empty),
  // complete or partial. Empty if there is none.
  std::string FindRun(const std::string& sequence) const;

  // Creates an empty folder to work in.
  void Begin(const BatchRun& run) const;

  // Marks the run as done and replaces an earlier result.
  void Finish(const BatchRun& run, const RunEnd& end) const;

 private:
  std::string output_;
};

// Locks an output folder for this process. A whole batch excludes all others;
// several shards may run together, but each only once. The lock is held until
// this process and all its child processes have ended, in any way, because
// children inherit the open files. So a run that briefly outlives a killed
// batch never writes at the same time as the next batch.
class BatchLock {
 public:
  // Throws InputError if another process uses the folder.
  BatchLock(const std::string& output, const BatchShard& shard);
  ~BatchLock();
  BatchLock(const BatchLock&) = delete;
  BatchLock& operator=(const BatchLock&) = delete;

 private:
  int folder_file_ = -1;
  int shard_file_ = -1;  // -1 for a whole batch
};

}  // namespace rgbd_pose
