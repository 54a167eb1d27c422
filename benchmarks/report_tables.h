#pragma once

#include <map>
#include <string>
#include <vector>

#include "benchmarks/results.h"
#include "benchmarks/speedups.h"

namespace rgbd_pose {

// The replacements of the @NAMES@ in benchmarks.md.in: rows of tables and
// single figures. Benchmarks that were not run have no row. `load_after` is the
// system's load after all benchmarks.
std::map<std::string, std::string> ReportTables(
    const BenchmarkResults& results, const std::vector<SpeedupRow>& speedups,
    double load_after);

}  // namespace rgbd_pose
