#pragma once

#include <optional>
#include <string>

#include "apps/batch/batch_plan.h"

namespace rgbd_pose {

// How a run ended, as its done.json says.
struct RunEnd {
  std::string status;  // ok, failed, timeout or crashed
  int exit_code = 0;   // of the program; 128 + signal if one ended it
  std::string hash;    // of the run (BatchRun::hash)
};

// The folders of the runs of one batch. A run works in "<name>.partial", which
// becomes "<name>" in one step when it has ended: what has its name is
// complete. All throw InputError if a folder or file cannot be written.
class BatchFolder {
 public:
  explicit BatchFolder(std::string output) : output_(std::move(output)) {}

  const std::string& output() const { return output_; }
  std::string Complete(const BatchRun& run) const;
  std::string Partial(const BatchRun& run) const;

  // How a run has ended; empty if it has not, or with another hash.
  std::optional<RunEnd> ReadEnd(const BatchRun& run) const;

  // Whether there is a run that has ended, whatever its hash.
  bool Holds(const BatchRun& run) const;

  // The first folder of a run in one sequence, complete or partial; in all
  // sequences for an empty name. Empty if there is none.
  std::string FindRun(const std::string& sequence) const;

  // Makes an empty folder to work in.
  void Begin(const BatchRun& run) const;

  // Marks the run as done, in place of an earlier one.
  void Finish(const BatchRun& run, const RunEnd& end) const;

 private:
  std::string output_;
};

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
