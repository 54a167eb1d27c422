// Runs every benchmark program for a moment and makes a page of what they say:
// not how fast anything is, but that it can still be measured.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/text_file.h"
#include "tests/run_program.h"
#include "tests/temp_folder.h"

namespace rgbd_pose {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kTemplate = RGBD_POSE_BENCHMARK_PAGE;

class BenchmarkProgramsTest : public ::testing::Test {
 protected:
  std::string Run(const std::string& command) {
    const RunResult run = RunCommand(command, folder_);
    EXPECT_EQ(run.exit_code, 0) << command << "\n" << run.err;
    return run.out;
  }

  // Runs those benchmarks of a Google Benchmark program that match.
  std::string Measure(const std::string& program, const std::string& filter) {
    return folder_.Write(
        std::filesystem::path(program).filename().string() + ".json",
        Run(program + " --benchmark_filter='" + filter +
            "' --benchmark_min_time=0.001 --benchmark_repetitions=2 "
            "--benchmark_enable_random_interleaving=true "
            "--benchmark_format=json"));
  }

  std::string Report(const std::string& results,
                     const std::string& native_results = "") {
    return Run(std::string(BENCHMARK_REPORT) + " --results=" + results +
               " --native_results=" + native_results + " --page_template=" +
               kTemplate + " --page=" + page_ + " --speedups=" + speedups_);
  }

  TempFolder folder_;
  const std::string page_ = folder_ / "page.md";
  const std::string speedups_ = folder_ / "speedups.json";
};

TEST_F(BenchmarkProgramsTest, AreMeasuredAndReported) {
  const std::string frames = folder_ / "frames.json";
  Run(std::string(FRAMES_BENCHMARK) +
      " --frames=3 --rounds=2 --path=still --output=" + frames);
  const std::string solve =
      Measure(SOLVE_BENCHMARK, "huber/30$|tukey/30$|huber/300$");
  Report(solve + "," + Measure(JACOBIAN_BENCHMARK, ".") + "," +
             Measure(PEERS_BENCHMARK, ".") + "," + frames,
         solve);

  const std::string page = ReadTextFile(page_);
  EXPECT_THAT(page, Not(HasSubstr("@")));
  for (const char* row : {"| `compressed` | QR | ", "| 30, huber | ",
                          "| `bidirectional_point` | ", "| `estimator` | ",
                          "| `room_still` | `rgbd_pose` | ",
                          "| `solve_n300_compressed_over_autodiff` | "}) {
    EXPECT_THAT(page, HasSubstr(row));
  }
  const nlohmann::json speedups =
      nlohmann::json::parse(ReadTextFile(speedups_));
  for (const char* key : {"solve_n300_compressed_over_autodiff",
                          "solve_n300_compressed_over_per_match",
                          "solve_n300_compressed_over_bare_loop",
                          "jacobian_bidirectional_point_analytic_over_autodiff",
                          "estimate_over_pnp_ransac"}) {
    ASSERT_TRUE(speedups.contains(key)) << key;
    EXPECT_GT(speedups[key], 0.0) << key;
  }
}

TEST_F(BenchmarkProgramsTest, ReportLeavesOutWhatWasNotMeasured) {
  Report(Measure(PEERS_BENCHMARK, "/ransac$"));
  EXPECT_EQ(nlohmann::json::parse(ReadTextFile(speedups_)),
            nlohmann::json::object());
  EXPECT_THAT(ReadTextFile(page_), HasSubstr("| `ransac` | "));
  EXPECT_THAT(ReadTextFile(page_), Not(HasSubstr("| `estimator` | ")));
}

TEST_F(BenchmarkProgramsTest, ReportRejectsBadInput) {
  const std::string results = folder_.Write("no.json", "no");
  const RunResult run =
      RunCommand(std::string(BENCHMARK_REPORT) + " --results=" + results +
                     " --page_template=" + kTemplate + " --page=" + page_ +
                     " --speedups=" + speedups_,
                 folder_);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr(results));
}

}  // namespace
}  // namespace rgbd_pose
