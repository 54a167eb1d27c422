#include "benchmarks/report_tables.h"

#include <algorithm>
#include <cmath>

#include "benchmarks/machine.h"
#include "core/util/format.h"
#include "costs/cost_factory.h"
#include "costs/direct_cost_factory.h"

namespace rgbd_pose {
namespace {

constexpr int kSizes[] = {30, 100, 300, 1000, 10000, 100000};

std::string Fixed(double value, int decimals) {
  return Format("%.*f", decimals, value);
}

// With three significant digits.
std::string Number(double value) {
  if (!(std::abs(value) > 0.0)) return Fixed(value, 0);
  const int magnitude = static_cast<int>(std::floor(std::log10(value)));
  return Fixed(value, std::max(0, 2 - magnitude));
}

std::string Row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += " " + cell + " |";
  return row + "\n";
}

// The unit in which a time is shown.
struct TimeUnit {
  const char* name = "ns";
  double ns = 1.0;

  explicit TimeUnit(double time_ns) {
    if (time_ns >= 1e3) *this = {"us", 1e3};
    if (time_ns >= 1e6) *this = {"ms", 1e6};
  }
  TimeUnit(const char* unit_name, double unit_ns)
      : name(unit_name), ns(unit_ns) {}
};

// "28.2 us", or empty.
std::string Time(const BenchmarkResult* result) {
  if (result == nullptr) return "";
  const double median = SpreadOf(result->cpu_ns).median;
  const TimeUnit unit(median);
  return Number(median / unit.ns) + " " + unit.name;
}

// "28.2 us [27.9, 28.6]".
std::string TimeWithQuartiles(const BenchmarkResult& result) {
  const Spread spread = SpreadOf(result.cpu_ns);
  const TimeUnit unit(spread.median);
  return Time(&result) + " [" + Number(spread.lower_quartile / unit.ns) + ", " +
         Number(spread.upper_quartile / unit.ns) + "]";
}

std::string Ratio(const BenchmarkResult* ours, const BenchmarkResult* theirs) {
  if (ours == nullptr || theirs == nullptr) return "";
  return Number(SpeedupOf(*ours, *theirs));
}

// The median of a counter with three significant digits, or empty.
std::string Counter(const BenchmarkResult& result, const std::string& name,
                    double factor = 1.0) {
  const auto found = result.counters.find(name);
  if (found == result.counters.end()) return "";
  return Number(factor * SpreadOf(found->second).median);
}

// The median of a counter as an integer, or empty.
std::string Count(const BenchmarkResult& result, const std::string& name) {
  const auto found = result.counters.find(name);
  if (found == result.counters.end()) return "";
  return Fixed(SpreadOf(found->second).median, 0);
}

std::string SolveRows(const BenchmarkResults& results) {
  const std::string rows[][2] = {
      {"autodiff", "autodiff/cholesky"},
      {"per_match", "per_match/cholesky"},
      {"compressed", "compressed/cholesky"},
      {"compressed, SSE2 only", "compressed_sse2/cholesky"},
      {"bare_loop", "bare_loop"}};
  std::string text;
  for (const auto& [assembly, name] : rows) {
    const BenchmarkResult* result =
        results.Find("solve/" + name + "/huber/300");
    if (result == nullptr) continue;
    text += Row({"`" + assembly + "`", TimeWithQuartiles(*result)});
  }
  return text;
}

std::string SizeRows(const BenchmarkResults& results) {
  std::string text;
  for (const int size : kSizes) {
    const auto find = [&](const std::string& assembly) {
      return results.FindFastest(SolveNames(assembly, "huber", size));
    };
    const std::string number = std::to_string(size);
    const BenchmarkResult* autodiff = find("autodiff");
    const BenchmarkResult* per_match = find("per_match");
    const BenchmarkResult* ours = find("compressed");
    if (ours == nullptr) continue;
    text += Row({number, Time(autodiff), Time(ours), Ratio(ours, autodiff),
                 Ratio(ours, per_match),
                 Time(results.Find("estimate/compressed/tukey/" + number))});
  }
  return text;
}

// A sentence with the smallest and largest values over all costs.
std::string Jacobians(const BenchmarkResults& results) {
  std::vector<std::string> costs = CostNames();
  for (const std::string& cost : DirectCostNames()) costs.push_back(cost);
  std::map<double, std::string> times, ratios;  // with their costs
  for (const std::string& cost : costs) {
    const std::string alone = "jacobian/alone/" + cost;
    const BenchmarkResult* by_hand = results.Find(alone + "/analytic");
    const BenchmarkResult* by_jet = results.Find(alone + "/autodiff");
    if (by_hand == nullptr || by_jet == nullptr) continue;
    times[SpreadOf(by_hand->cpu_ns).median] = cost;
    ratios[SpeedupOf(*by_hand, *by_jet)] = cost;
  }
  if (times.empty()) return "";
  const auto range = [](const std::map<double, std::string>& values,
                        const std::string& unit) {
    const auto& [low, fewest] = *values.begin();
    const auto& [high, most] = *values.rbegin();
    return Number(low) + unit + " (`" + fewest + "`) to " + Number(high) +
           unit + " (`" + most + "`)";
  };
  return range(times, " ns") + ", " + range(ratios, "") +
         " times as fast as automatic differentiation.";
}

std::string GraphRows(const BenchmarkResults& results) {
  std::string text;
  for (const char* keyframes : {"100", "1000"}) {
    for (const char* way : {"odometry", "edges", "map", "bundle_adjustment"}) {
      const BenchmarkResult* result =
          results.Find(std::string("graph/") + way + "/" + keyframes);
      if (result == nullptr) continue;
      text += Row({keyframes, std::string("`") + way + "`",
                   std::string(way) == "odometry" ? "" : Time(result),
                   Counter(*result, "error_mm"),
                   Counter(*result, "wrong_focal_mm")});
    }
  }
  return text;
}

std::string PeerRows(const BenchmarkResults& results) {
  std::string text;
  for (const char* method : {"estimator", "ransac", "umeyama_ransac",
                             "pnp_ransac", "pnp_ransac_refined"}) {
    const BenchmarkResult* result =
        results.Find(std::string("peers/") + method);
    if (result == nullptr) continue;
    text += Row({std::string("`") + method + "`", Time(result),
                 Counter(*result, "rotation_deg"),
                 Counter(*result, "translation_mm"), Count(*result, "solved")});
  }
  return text;
}

std::string FrameRows(const BenchmarkResults& results) {
  std::string text;
  for (const std::string& sequence : TrackedSequences(results)) {
    for (const char* method :
         {"rgbd_pose", "rgbd_pose_direct", "rgbd_pose_hybrid", "opencv_rgbd",
          "opencv_icp", "opencv_rgbdicp", "open3d_hybrid"}) {
      const BenchmarkResult* result =
          results.Find("frames/" + sequence + "/" + method);
      if (result == nullptr) continue;
      text += Row({"`" + sequence + "`", std::string("`") + method + "`",
                   Time(result), Counter(*result, "ate_m", 1e3),
                   Counter(*result, "rpe_m", 1e3)});
    }
  }
  return text;
}

// The aims that were missed.
std::string Aims(const std::vector<SpeedupRow>& speedups) {
  int aims = 0, missed = 0;
  std::string names;
  for (const auto& [key, speedup, aim] : speedups) {
    if (!(aim > 0.0)) continue;
    ++aims;
    if (speedup >= aim) continue;
    ++missed;
    names += (names.empty() ? ": `" : ", `") + key + "` " + Number(speedup) +
             " (>= " + Number(aim) + ")";
  }
  return std::to_string(aims) + " speed-ups have targets; " +
         std::to_string(missed) + " of them were missed" + names + ".";
}

}  // namespace

std::map<std::string, std::string> ReportTables(
    const BenchmarkResults& results, const std::vector<SpeedupRow>& speedups,
    double load_after) {
  std::string loads;
  for (const double load : results.load) {
    loads += (loads.empty() ? "" : ", ") + Fixed(load, 2);
  }
  std::vector<double> waits;
  for (const auto& [name, result] : results.benchmarks) {
    waits.push_back(SpreadOf(result.real_ns).median /
                    SpreadOf(result.cpu_ns).median);
  }
  const Spread wait = SpreadOf(waits);
  return {{"LOADS", loads},
          {"LOAD_AFTER", Fixed(load_after, 2)},
          {"WALL_MEDIAN", Fixed(wait.median, 2)},
          {"WALL_MAX", Fixed(wait.max, 2)},
          {"SOLVE", SolveRows(results)},
          {"SIZES", SizeRows(results)},
          {"JACOBIANS", Jacobians(results)},
          {"GRAPHS", GraphRows(results)},
          {"PEERS", PeerRows(results)},
          {"FRAMES", FrameRows(results)},
          {"AIMS", Aims(speedups)}};
}

}  // namespace rgbd_pose
