#include "benchmarks/results.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

double Nanoseconds(const std::string& unit, const std::string& path) {
  if (unit == "ns") return 1.0;
  if (unit == "us") return 1e3;
  if (unit == "ms") return 1e6;
  if (unit == "s") return 1e9;
  throw InputError(path + ": unknown time unit '" + unit +
                   "'; available: ns, us, ms, s");
}

void AddEntry(const nlohmann::json& entry, const std::string& path,
              BenchmarkResult* result) {
  for (const auto& [key, value] : entry.items()) {
    if (value.is_number()) result->counters[key].push_back(value);
  }
  const double calls = entry.value("calls", 1.0);
  const double unit = Nanoseconds(entry.at("time_unit"), path) / calls;
  result->cpu_ns.push_back(entry.at("cpu_time").get<double>() * unit);
  result->real_ns.push_back(entry.at("real_time").get<double>() * unit);
}

}  // namespace

void BenchmarkResults::Read(const std::string& path) {
  try {
    const nlohmann::json json = nlohmann::json::parse(ReadTextFile(path));
    load.push_back(json.at("context").at("load_avg").at(0));
    for (const nlohmann::json& entry : json.at("benchmarks")) {
      if (entry.at("run_type") != "iteration") continue;
      AddEntry(entry, path, &benchmarks[entry.at("name")]);
    }
  } catch (const nlohmann::json::exception& e) {
    throw InputError(path + ": no output of a benchmark program (" + e.what() +
                     "); run it with --benchmark_format=json");
  }
}

const BenchmarkResult* BenchmarkResults::Find(const std::string& name) const {
  const auto found = benchmarks.find(name);
  return found == benchmarks.end() ? nullptr : &found->second;
}

const BenchmarkResult* BenchmarkResults::FindFastest(
    const std::vector<std::string>& names) const {
  const BenchmarkResult* fastest = nullptr;
  for (const std::string& name : names) {
    const BenchmarkResult* result = Find(name);
    if (result == nullptr) continue;
    if (fastest == nullptr ||
        SpreadOf(result->cpu_ns).median < SpreadOf(fastest->cpu_ns).median) {
      fastest = result;
    }
  }
  return fastest;
}

Spread SpreadOf(const std::vector<double>& values) {
  return {Quantile(values, 0.0), Quantile(values, 0.25), Quantile(values, 0.5),
          Quantile(values, 0.75), Quantile(values, 1.0)};
}

double SpeedupOf(const BenchmarkResult& ours, const BenchmarkResult& theirs) {
  return SpreadOf(theirs.cpu_ns).median / SpreadOf(ours.cpu_ns).median;
}

}  // namespace rgbd_pose
