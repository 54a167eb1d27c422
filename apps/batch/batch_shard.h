#pragma once

#include <string>

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

// The shard that "i/n" says, 0 <= i < n. If it is empty, the one of this task
// of a Slurm job array (SLURM_ARRAY_TASK_ID, _COUNT and _MIN), or else the
// whole. Throws InputError for anything else, and for arrays with gaps.
BatchShard ParseShard(const std::string& text);

}  // namespace rgbd_pose
