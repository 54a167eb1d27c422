#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/batch/batch_list.h"

namespace rgbd_pose {

// A part of a batch: every count-th sequence, beginning with number index.
struct BatchShard {
  int index = 0;
  int count = 1;

  bool IsWhole() const { return count == 1; }
  bool Has(int sequence) const { return sequence % count == index; }

  // "0-of-4", for file names.
  std::string Name() const;
};

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

// The shard that "i/n" says, 0 <= i < n. If it is empty, the one of this task
// of a Slurm job array (SLURM_ARRAY_TASK_ID, _COUNT and _MIN), or else the
// whole. Throws InputError for anything else, and for arrays with gaps.
BatchShard ParseShard(const std::string& text);

// A hash of all that a run reads of a sequence: rgb.txt, depth.txt, the name
// and size of each image in them, groundtruth.txt and the camera. Files that
// are missing count as such; where the sequence lies does not count.
std::string HashSequence(const BatchSequence& sequence);

// A hash of what a program does: of its file, and of the project's own shared
// libraries, if it is built with such. (Those that this process has loaded:
// programs that are installed together share them.)
std::string HashProgram(const std::string& path);

}  // namespace rgbd_pose
