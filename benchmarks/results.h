#pragma once

#include <map>
#include <string>
#include <vector>

namespace rgbd_pose {

// Repetitions of one benchmark.
struct BenchmarkResult {
  // CPU and wall time in nanoseconds per call, one value per repetition.
  std::vector<double> cpu_ns;
  std::vector<double> real_ns;
  // All other numbers of a repetition, by name.
  std::map<std::string, std::vector<double>> counters;
};

// The measurements of the benchmark programs, by benchmark name.
struct BenchmarkResults {
  std::map<std::string, BenchmarkResult> benchmarks;
  // The system's load (mean of one minute) at the start of each program.
  std::vector<double> load;

  // Adds the JSON output of a Google Benchmark program (or of one with the same
  // format). Times are divided by the counter "calls" if there is one;
  // aggregates are skipped. Throws InputError if the file cannot be used.
  void Read(const std::string& path);

  // Null if the benchmark was not measured.
  const BenchmarkResult* Find(const std::string& name) const;

  // The one of these benchmarks with the smallest median CPU time; null if none
  // was measured.
  const BenchmarkResult* FindFastest(
      const std::vector<std::string>& names) const;
};

// Quantiles of values (at least one), with linear interpolation.
struct Spread {
  double min, lower_quartile, median, upper_quartile, max;
};
Spread SpreadOf(const std::vector<double>& values);

// How many times faster `ours` is than `theirs`, from the median CPU times of a
// run.
double SpeedupOf(const BenchmarkResult& ours, const BenchmarkResult& theirs);

}  // namespace rgbd_pose
