#pragma once

#include <string>
#include <vector>

#include "apps/batch/batch_list.h"
#include "apps/batch/batch_shard.h"

namespace rgbd_pose {

// One run of the odometry.
struct BatchRun {
  BatchSequence sequence;
  std::string cost;
  std::string loss;
  std::string frontend;
  int repeat = 1;
  std::string hash;  // of settings, program and inputs: same hash, same result

  // Where it is kept: "<sequence>/<cost>-<loss>-<frontend>-r<repeat>".
  std::string Name() const;
};

// What is varied: all combinations are run.
struct BatchGrid {
  std::vector<std::string> costs;
  std::vector<std::string> losses;
  std::vector<std::string> frontends;
  int repeats = 1;
};

// The grid from lists set apart by commas. Throws InputError for names that do
// not exist or come twice.
BatchGrid ParseGrid(const std::string& costs, const std::string& losses,
                    const std::string& frontends, int repeats);

// The runs of a shard, in the order of the list of sequences, then costs,
// losses, frontends and repeats. `settings` is all else that changes a result.
std::vector<BatchRun> MakePlan(const std::vector<BatchSequence>& sequences,
                               const BatchGrid& grid, const BatchShard& shard,
                               const std::string& settings);

}  // namespace rgbd_pose
