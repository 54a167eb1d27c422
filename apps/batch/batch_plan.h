#pragma once

#include <functional>
#include <string>
#include <vector>

namespace rgbd_pose {

struct BatchSequence {
  std::string name;    // folder name in the output; unique in a list
  std::string folder;  // absolute
  std::string camera;  // a preset or an absolute path; empty: in the recording
};

// Reads a list of sequences, one per line: a folder and optionally its camera
// (preset or YAML file; default: camera.yaml of the folder). Paths are relative
// to the folder of the list. A folder may be a pattern (*, ?, [...]), which
// stands for all matches in order of name. Throws InputError (file:line) for a
// line without a valid folder or camera and for duplicate names.
std::vector<BatchSequence> ReadSequenceList(const std::string& path);

// A part of a batch: every count-th sequence, starting at index.
struct BatchShard {
  int index = 0;
  int count = 1;

  bool IsWhole() const { return count == 1; }
  bool Has(int sequence) const { return sequence % count == index; }

  // "0-of-4", for file names.
  std::string Name() const {
    return std::to_string(index) + "-of-" + std::to_string(count);
  }
};

// A setting that runs of a sequence may vary, and a part of their folder names.
struct BatchSetting {
  const char* list;    // flag of rgbd_batch with comma-separated values
  const char* flag;    // flag of the program that runs
  const char* column;  // column of the summary
  std::function<void(const std::string& value)> check;  // throws InputError
};

const std::vector<BatchSetting>& BatchSettings();

struct BatchRun {
  BatchSequence sequence;
  std::vector<std::string> values;  // of BatchSettings(), in their order
  int repeat = 1;
  std::string hash;  // of settings, program and inputs: same hash, same result

  // The folder of the run: "<sequence>/<values, joined by '-'>-r<repeat>".
  std::string Name() const;
};

// What is run on each sequence.
struct BatchGrid {
  std::vector<std::vector<std::string>> combinations;  // of BatchRun::values
  int repeats = 1;
};

// Makes the grid of all combinations from one list for each of BatchSettings();
// the last ones vary fastest. Throws InputError for unknown or double values.
BatchGrid ParseGrid(const std::vector<std::string>& lists, int repeats);

// Returns the runs of a shard, ordered by sequence (as listed), combination and
// repeat. `settings` is everything else that affects a result.
std::vector<BatchRun> MakePlan(const std::vector<BatchSequence>& sequences,
                               const BatchGrid& grid, const BatchShard& shard,
                               const std::string& settings);

// Parses a shard "i/n". An empty text means the task of a Slurm job array or,
// outside of one, the whole batch. Throws InputError if invalid or with gaps.
BatchShard ParseShard(const std::string& text);

// Hashes all input of a run on a sequence: rgb.txt, depth.txt, the name and
// size of each image in them and the size of its mask, groundtruth.txt, the
// inertial samples and the camera. Missing files are part of the hash; the
// location of the sequence is not.
std::string HashSequence(const BatchSequence& sequence);

// Hashes the program file and the project's shared libraries that this process
// has loaded, because programs that are installed together share them.
std::string HashProgram(const std::string& path);

}  // namespace rgbd_pose
