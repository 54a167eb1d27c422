#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/batch/batch_list.h"
#include "apps/batch/batch_shard.h"

namespace rgbd_pose {

// What may differ between the runs of a sequence. A row makes it a list of the
// plan, a flag of every run, a part of its folder's name and a column of the
// summary.
struct BatchSetting {
  const char* list;    // of rgbd_batch, with values separated by commas
  const char* flag;    // of the program that is run
  const char* column;  // of the summary
  std::function<void(const std::string& value)> check;  // throws InputError
};

const std::vector<BatchSetting>& BatchSettings();

// One run of the odometry.
struct BatchRun {
  BatchSequence sequence;
  std::vector<std::string> values;  // of BatchSettings(), in their order
  int repeat = 1;
  std::string hash;  // of settings, program and inputs: same hash, same result

  // Where it is kept: "<sequence>/<values, joined by '-'>-r<repeat>".
  std::string Name() const;
};

// What is varied: all combinations are run.
struct BatchGrid {
  std::vector<std::vector<std::string>> values;  // of each of BatchSettings()
  int repeats = 1;
};

// The grid from one list for each of BatchSettings(). Throws InputError for
// values that do not exist or come twice.
BatchGrid ParseGrid(const std::vector<std::string>& lists, int repeats);

// The runs of a shard, in the order of the list of sequences, then of the
// values, the last ones fastest, then repeats. `settings` is all else that
// changes a result.
std::vector<BatchRun> MakePlan(const std::vector<BatchSequence>& sequences,
                               const BatchGrid& grid, const BatchShard& shard,
                               const std::string& settings);

}  // namespace rgbd_pose
