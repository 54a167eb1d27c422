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

// A time in the unit that suits.
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

// "28.2 us [27.9, 28.6]", or nothing.
std::string Time(const BenchmarkResult* result) {
  if (result == nullptr) return "";
  const Spread spread = SpreadOf(result->cpu_ns);
  const TimeUnit unit(spread.median);
  return Number(spread.median / unit.ns) + " " + unit.name + " [" +
         Number(spread.lower_quartile / unit.ns) + ", " +
         Number(spread.upper_quartile / unit.ns) + "]";
}

std::string Fastest(const BenchmarkResult& result) {
  const double ns = SpreadOf(result.cpu_ns).min;
  const TimeUnit unit(ns);
  return Number(ns / unit.ns) + " " + unit.name;
}

std::string Ratio(const BenchmarkResult* ours, const BenchmarkResult* theirs) {
  if (ours == nullptr || theirs == nullptr) return "";
  return Number(SpeedupOf(*ours, *theirs).ratio);
}

// The median of a counter, or nothing.
std::string Counter(const BenchmarkResult& result, const std::string& name,
                    double factor = 1.0) {
  const auto found = result.counters.find(name);
  if (found == result.counters.end()) return "";
  return Number(factor * SpreadOf(found->second).median);
}

// That of whole things.
std::string Count(const BenchmarkResult& result, const std::string& name) {
  const auto found = result.counters.find(name);
  if (found == result.counters.end()) return "";
  return Fixed(SpreadOf(found->second).median, 0);
}

std::string SolveRows(const BenchmarkResults& results) {
  const std::string rows[][3] = {
      {"plain", "QR", "plain/qr"},
      {"plain", "Cholesky", "plain/cholesky"},
      {"autodiff", "QR", "autodiff/qr"},
      {"autodiff", "Cholesky", "autodiff/cholesky"},
      {"per_match", "QR", "per_match/qr"},
      {"per_match", "Cholesky", "per_match/cholesky"},
      {"compressed", "QR", "compressed/qr"},
      {"compressed", "Cholesky", "compressed/cholesky"},
      {"compressed, SSE2 only", "Cholesky", "compressed_sse2/cholesky"},
      {"tiny_solver", "its own", "tiny_solver"},
      {"bare_loop", "LDLT", "bare_loop"}};
  std::string text;
  for (const auto& [assembly, solver, name] : rows) {
    const BenchmarkResult* result =
        results.Find("solve/" + name + "/huber/300");
    if (result == nullptr) continue;
    text += Row({"`" + assembly + "`", solver, Time(result), Fastest(*result),
                 Count(*result, "evaluations")});
  }
  return text;
}

std::string SizeRow(const BenchmarkResults& results, const std::string& loss,
                    int size) {
  const auto find = [&](const std::string& assembly) {
    return results.FindFastest(SolveNames(assembly, loss, size));
  };
  const std::string number = std::to_string(size);
  const BenchmarkResult* autodiff = find("autodiff");
  const BenchmarkResult* per_match = find("per_match");
  const BenchmarkResult* ours = find("compressed");
  const BenchmarkResult* bare =
      results.Find("solve/bare_loop/" + loss + "/" + number);
  if (ours == nullptr) return "";
  return Row({number + ", " + loss, Time(autodiff), Time(per_match), Time(ours),
              Time(bare), Ratio(ours, autodiff), Ratio(ours, per_match),
              Ratio(ours, bare)});
}

std::string SizeRows(const BenchmarkResults& results) {
  std::string text;
  for (const int size : kSizes) text += SizeRow(results, "huber", size);
  for (const char* loss : {"none", "tukey"}) {
    text += SizeRow(results, loss, 300);
  }
  return text;
}

std::string EstimateRows(const BenchmarkResults& results) {
  std::string text;
  for (const int size : kSizes) {
    const std::string number = std::to_string(size);
    const auto time = [&](const std::string& assembly) {
      return Time(results.Find("estimate/" + assembly + "/tukey/" + number));
    };
    if (time("compressed").empty()) continue;
    text +=
        Row({number, time("autodiff"), time("per_match"), time("compressed")});
  }
  return text;
}

std::string JacobianRows(const BenchmarkResults& results) {
  std::string text;
  for (const std::string& cost : CostNames()) {
    const auto find = [&](const std::string& where, const std::string& how) {
      return results.Find("jacobian/" + where + "/" + cost + "/" + how);
    };
    const BenchmarkResult* by_hand = find("alone", "analytic");
    const BenchmarkResult* by_jet = find("alone", "autodiff");
    if (by_hand == nullptr) continue;
    text += Row(
        {"`" + cost + "`", Time(by_hand), Time(by_jet), Ratio(by_hand, by_jet),
         Ratio(find("in_ceres", "analytic"), find("in_ceres", "autodiff"))});
  }
  return text;
}

std::string DirectRows(const BenchmarkResults& results) {
  std::string text;
  for (const std::string& cost : DirectCostNames()) {
    const auto find = [&](const std::string& what) {
      return results.Find("direct/" + what + "/10000");
    };
    const BenchmarkResult* rows = find("linearise/" + cost);
    if (rows == nullptr) continue;
    const BenchmarkResult* bare =
        cost == "photometric" ? find("linearise/bare_loop") : nullptr;
    const std::string alone = "jacobian/alone/" + cost;
    const BenchmarkResult* by_hand = results.Find(alone + "/analytic");
    const BenchmarkResult* by_jet = results.Find(alone + "/autodiff");
    text += Row({"`" + cost + "`", Time(rows), Time(bare),
                 Time(find("look_up/" + cost)), Time(by_hand), Time(by_jet),
                 Ratio(by_hand, by_jet)});
  }
  return text;
}

std::string GraphRows(const BenchmarkResults& results) {
  std::string text;
  for (const char* keyframes : {"100", "1000"}) {
    for (const char* way :
         {"odometry", "edges", "compressed", "per_match", "autodiff", "map",
          "bundle_adjustment", "map_window", "pairs"}) {
      const BenchmarkResult* result =
          results.Find(std::string("graph/") + way + "/" + keyframes);
      if (result == nullptr) continue;
      text +=
          Row({keyframes, Count(*result, "pairs"), std::string("`") + way + "`",
               std::string(way) == "odometry" ? "" : Time(result),
               Count(*result, "steps"), Counter(*result, "error_mm"),
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
                   Time(result), Counter(*result, "p99_ms"),
                   Counter(*result, "ate_m", 1e3),
                   Counter(*result, "rpe_m", 1e3), Counter(*result, "rpe_deg"),
                   Count(*result, "frames"), Count(*result, "failed")});
    }
  }
  return text;
}

// By how much the ratio of medians may differ from that of the fastest.
constexpr double kQuiet = 0.02;

// How far noise has moved a speed-up: above 0, for us.
double NoiseOf(const Speedup& speedup) {
  return speedup.ratio / speedup.by_minima - 1.0;
}

std::string SpeedupRows(const std::vector<SpeedupRow>& speedups) {
  std::string text;
  for (const auto& [key, speedup, aim] : speedups) {
    const double noise = NoiseOf(speedup);
    const std::string direction = noise > kQuiet    ? "for us"
                                  : noise < -kQuiet ? "against us"
                                                    : "neither";
    std::string target;
    if (aim > 0.0) {
      target =
          ">= " + Number(aim) + (speedup.ratio >= aim ? ", met" : ", not met");
    }
    text += Row({"`" + key + "`", Number(speedup.ratio),
                 Number(speedup.low) + " to " + Number(speedup.high),
                 Number(speedup.by_minima), direction, target});
  }
  return text;
}

std::string NoiseCount(const std::vector<SpeedupRow>& speedups) {
  int for_us = 0, against_us = 0;
  for (const SpeedupRow& row : speedups) {
    for_us += NoiseOf(row.speedup) > kQuiet;
    against_us += NoiseOf(row.speedup) < -kQuiet;
  }
  return "Of " + std::to_string(speedups.size()) + " speed-ups it raised " +
         std::to_string(for_us) + " by more than 2 % and lowered " +
         std::to_string(against_us) + ".";
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
          {"NOISE_COUNT", NoiseCount(speedups)},
          {"INSTRUCTION_SET", InstructionSetName()},
          {"SOLVE", SolveRows(results)},
          {"SIZES", SizeRows(results)},
          {"ESTIMATE", EstimateRows(results)},
          {"JACOBIANS", JacobianRows(results)},
          {"DIRECT", DirectRows(results)},
          {"GRAPHS", GraphRows(results)},
          {"PEERS", PeerRows(results)},
          {"FRAMES", FrameRows(results)},
          {"SPEEDUPS", SpeedupRows(speedups)}};
}

}  // namespace rgbd_pose
