#pragma once

#include <map>
#include <string>
#include <vector>

namespace rgbd_pose {

// Repetitions of one benchmark.
struct BenchmarkResult {
  // Nanoseconds a call, one a repetition: of the processor, and on the wall.
  std::vector<double> cpu_ns;
  std::vector<double> real_ns;
  // Whatever else a repetition gave in numbers, by name.
  std::map<std::string, std::vector<double>> counters;
};

// What benchmark programs have measured, by the names of the benchmarks.
struct BenchmarkResults {
  std::map<std::string, BenchmarkResult> benchmarks;
  // The system's load (mean of a minute) at the start of each program.
  std::vector<double> load;

  // Adds the JSON output of a Google Benchmark program (or one like it). Times
  // are divided by the counter "calls" where there is one; aggregates are left
  // out. Throws InputError if the file is of no use.
  void Read(const std::string& path);

  // Null if it was not measured.
  const BenchmarkResult* Find(const std::string& name) const;

  // Of the names that were measured, the one with the smallest median CPU time;
  // null if none was.
  const BenchmarkResult* FindFastest(
      const std::vector<std::string>& names) const;
};

// Quantiles of some values (not none); between two of them, interpolated.
struct Spread {
  double min, lower_quartile, median, upper_quartile, max;
};
Spread SpreadOf(const std::vector<double>& values);

// How many times faster `ours` is than `theirs`, by the medians of CPU times of
// one run.
double SpeedupOf(const BenchmarkResult& ours, const BenchmarkResult& theirs);

}  // namespace rgbd_pose
