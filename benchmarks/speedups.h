#pragma once

#include <string>
#include <vector>

#include "benchmarks/results.h"

namespace rgbd_pose {

// A speed-up that the benchmarks measure.
struct SpeedupRow {
  std::string key;  // in benchmarks.json: <what>_<ours>_over_<theirs>
  double speedup;
  double aim;  // the goal; 0: none
};

// All speed-ups with both sides measured. If several linear solvers were
// measured, the fastest one of each side is used (best against best); keys that
// name one (qr, cholesky) use it on both sides.
std::vector<SpeedupRow> FindSpeedups(const BenchmarkResults& results);

// The benchmarks of one solve with an assembly, one for each linear solver; for
// `autodiff` followed by the benchmarks of the plain Ceres blocks.
std::vector<std::string> SolveNames(const std::string& assembly,
                                    const std::string& loss, int matches);

// The tracked sequences.
std::vector<std::string> TrackedSequences(const BenchmarkResults& results);

}  // namespace rgbd_pose
