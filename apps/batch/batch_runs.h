#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

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

// Locks an output folder. A whole batch excludes all others; several shards may
// run together, each once. Child processes inherit the lock, so a run that
// outlives a killed batch never writes at the same time as the next batch.
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

struct BatchPoolOptions {
  // The path of rgbd_odometry, and arguments of every run before its own.
  std::vector<std::string> command;

  int jobs = 1;                  // processes at a time
  double timeout_seconds = 0.0;  // per run; 0: none

  // Called for each run after it has ended and is in its folder.
  std::function<void(const BatchRun& run, const RunEnd& end, double seconds)>
      on_end;
};

// Executes all runs, each in its own process, started in the given order. A run
// that fails, crashes or takes too long does not stop the others.
void RunBatch(const std::vector<BatchRun>& runs, const BatchFolder& folder,
              const BatchPoolOptions& options);

// One row per run of a plan, in plan order, from the files in its folder. Keys
// include units, unknown values are null, and times are last. A run without a
// result of the same hash has the status "missing".
using BatchSummary = std::vector<nlohmann::ordered_json>;

BatchSummary Summarise(const std::vector<BatchRun>& runs,
                       const BatchFolder& folder);

// For programs: CSV with a header and one row per run, or a JSON array of
// objects.
std::string FormatBatchCsv(const BatchSummary& summary);
std::string FormatBatchJson(const BatchSummary& summary);

// For people: the main figures of each run. If a sequence has several parts,
// their median, minimum and maximum instead.
std::string FormatBatchTable(const BatchSummary& summary);

}  // namespace rgbd_pose
