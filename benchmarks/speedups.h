#pragma once

#include <string>
#include <vector>

#include "benchmarks/results.h"

namespace rgbd_pose {

// A speed-up that benchmarks are made to tell.
struct SpeedupRow {
  std::string key;  // in benchmarks.json: <what>_<ours>_over_<theirs>
  double speedup;
  double aim;  // what was hoped for; 0: nothing in particular
};

// All speed-ups for which both sides were measured. Where several linear
// solvers were tried, the fastest of each side (best against best); keys that
// name one (qr, cholesky) have it on both sides.
std::vector<SpeedupRow> FindSpeedups(const BenchmarkResults& results);

// The benchmarks of one solve by an assembly, one for each linear solver;
// `autodiff` has those of the plain Ceres blocks after its own.
std::vector<std::string> SolveNames(const std::string& assembly,
                                    const std::string& loss, int matches);

// The sequences that were tracked.
std::vector<std::string> TrackedSequences(const BenchmarkResults& results);

}  // namespace rgbd_pose
