// Runs the benchmark programs as briefly as possible and makes the page of
// their results. No timing is checked here.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "core/util/text_file.h"
#include "tests/support/run_program.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;

class BenchmarkProgramsTest : public testing::Test {
 protected:
  // Runs the benchmarks that match the filter; returns the path of the results.
  std::string Measure(const std::string& program, const std::string& filter,
                      int repetitions = 2) {
    const RunResult run = RunCommand(
        program + " --benchmark_min_time=0.001 --benchmark_repetitions=" +
            std::to_string(repetitions) +
            " --benchmark_format=json --benchmark_filter='" + filter + "'",
        folder_);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return folder_.Write(std::to_string(++files_) + ".json", run.out);
  }

  TempFolder folder_;
  int files_ = 0;
};

TEST_F(BenchmarkProgramsTest, PlacesAreFound) {
  const nlohmann::json results = nlohmann::json::parse(
      ReadTextFile(Measure(PLACES_BENCHMARK, "places/query/100/")));
  int runs = 0;
  for (const auto& run : results.at("benchmarks")) {
    if (run["run_type"] != "iteration") continue;
    EXPECT_EQ(run["found"], 1.0);
    ++runs;
  }
  EXPECT_EQ(runs, 2);
}

TEST_F(BenchmarkProgramsTest, GraphsTakeDriftBack) {
  const nlohmann::json results = nlohmann::json::parse(ReadTextFile(
      Measure(GRAPH_BENCHMARK,
              "graph/(odometry|edges|map|bundle_adjustment)/100$", 1)));
  std::map<std::string, double> errors;
  for (const auto& run : results.at("benchmarks")) {
    if (run["run_type"] == "iteration") errors[run["name"]] = run["error_mm"];
  }
  EXPECT_GT(errors.at("graph/odometry/100"), 4.0);
  for (const char* way : {"edges", "map", "bundle_adjustment"}) {
    EXPECT_LT(errors.at(std::string("graph/") + way + "/100"), 2.5) << way;
  }
}

TEST_F(BenchmarkProgramsTest, MakeThePageAndTheSpeedups) {
  std::string results =
      Measure(SOLVE_BENCHMARK, "^(solve|estimate)/.*/(huber|tukey)/300$");
  results += "," + Measure(JACOBIAN_BENCHMARK, "bidirectional_point");
  results += "," + Measure(DIRECT_BENCHMARK, "photometric|bare_loop");
  results +=
      "," + Measure(GRAPH_BENCHMARK, "graph/(edges|bundle_adjustment)/100$");
  results += "," + Measure(PEERS_BENCHMARK, "estimator|pnp_ransac$");
  const std::string frames = folder_ / "frames.json";
  const RunResult tracked =
      RunCommand(std::string(FRAMES_BENCHMARK) +
                     " --frames=3 --rounds=1 --output=" + frames,
                 folder_);
  ASSERT_EQ(tracked.exit_code, 0) << tracked.err;
  results += "," + frames;

  const std::string page = folder_ / "page.md";
  const std::string speedups = folder_ / "benchmarks.json";
  const RunResult report = RunCommand(
      std::string(BENCHMARK_REPORT) + " --results=" + results +
          " --page_template=" + BENCHMARK_PAGE_TEMPLATE +
          " --machine='a test' --page=" + page + " --speedups=" + speedups,
      folder_);
  ASSERT_EQ(report.exit_code, 0) << report.err;

  const std::string text = ReadTextFile(page);
  EXPECT_THAT(text, HasSubstr("| machine | a test"));
  EXPECT_THAT(text, Not(HasSubstr("@"))) << "a mark was left";
  for (const char* method :
       {"rgbd_pose", "rgbd_pose_direct", "rgbd_pose_hybrid"}) {
    const std::string row =
        std::string("| `room_xyz` | 3 | `") + method + "` |";
    ASSERT_THAT(text, HasSubstr(row));
    EXPECT_EQ(text.find(row), text.rfind(row)) << "twice: " << row;
  }
  const nlohmann::json ratios = nlohmann::json::parse(ReadTextFile(speedups));
  for (const char* key :
       {"solve_n300_compressed_over_autodiff",
        "solve_n300_compressed_over_per_match",
        "solve_n300_compressed_over_bare_loop",
        "jacobian_bidirectional_point_analytic_over_autodiff",
        "jacobian_photometric_analytic_over_autodiff",
        "direct_photometric_over_bare_loop",
        "graph_100_edges_over_bundle_adjustment", "estimate_over_pnp_ransac"}) {
    ASSERT_TRUE(ratios.contains(key)) << key;
    EXPECT_GT(ratios[key].get<double>(), 0.0) << key;
  }
}

}  // namespace
}  // namespace rgbd_pose
