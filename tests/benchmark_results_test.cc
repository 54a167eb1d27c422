#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "benchmarks/results.h"
#include "benchmarks/speedups.h"
#include "tests/expect_input_error.h"
#include "tests/temp_folder.h"

namespace rgbd_pose {
namespace {

using ::testing::ElementsAre;

constexpr double kRounding = 1e-12;  // sums of a few doubles

BenchmarkResult ResultOf(std::vector<double> cpu_ns) {
  BenchmarkResult result;
  result.cpu_ns = std::move(cpu_ns);
  result.real_ns = result.cpu_ns;
  return result;
}

TEST(SpreadTest, InterpolatesQuantiles) {
  const Spread spread = SpreadOf({4.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(spread.min, 1.0);
  EXPECT_NEAR(spread.lower_quartile, 1.75, kRounding);
  EXPECT_NEAR(spread.median, 2.5, kRounding);
  EXPECT_NEAR(spread.upper_quartile, 3.25, kRounding);
  EXPECT_EQ(spread.max, 4.0);
}

TEST(SpreadTest, OfOneValueIsThatValue) {
  const Spread spread = SpreadOf({7.0});
  EXPECT_EQ(spread.min, 7.0);
  EXPECT_EQ(spread.median, 7.0);
  EXPECT_EQ(spread.max, 7.0);
}

TEST(SpeedupTest, IsAboveOneWhereOursIsFaster) {
  const Speedup speedup =
      SpeedupOf(ResultOf({1.0, 2.0, 3.0}), ResultOf({8.0, 10.0, 12.0}));
  EXPECT_NEAR(speedup.ratio, 5.0, kRounding);
  EXPECT_NEAR(speedup.low, 9.0 / 2.5, kRounding);
  EXPECT_NEAR(speedup.high, 11.0 / 1.5, kRounding);
  EXPECT_NEAR(speedup.by_minima, 8.0, kRounding);
}

TEST(SpeedupsTest, TakeTheFasterLinearSolverOfEachSide) {
  BenchmarkResults results;
  results.benchmarks["solve/compressed/qr/huber/300"] = ResultOf({2.0});
  results.benchmarks["solve/compressed/cholesky/huber/300"] = ResultOf({4.0});
  results.benchmarks["solve/autodiff/qr/huber/300"] = ResultOf({60.0});
  results.benchmarks["solve/autodiff/cholesky/huber/300"] = ResultOf({40.0});
  std::map<std::string, double> ratios;
  for (const SpeedupRow& row : FindSpeedups(results)) {
    ratios[row.key] = row.speedup.ratio;
  }
  // Nothing is said of what was not measured.
  const std::map<std::string, double> expected = {
      {"solve_n300_compressed_over_autodiff", 20.0},
      {"solve_n300_qr_compressed_over_autodiff", 30.0},
      {"solve_n300_cholesky_compressed_over_autodiff", 10.0}};
  EXPECT_EQ(ratios, expected);
}

class BenchmarkResultsTest : public ::testing::Test {
 protected:
  std::string Write(const std::string& text) {
    return folder_.Write("results.json", text);
  }

  TempFolder folder_;
};

TEST_F(BenchmarkResultsTest, ReadsRepetitionsButNoAggregates) {
  BenchmarkResults results;
  results.Read(Write(R"({"context": {"load_avg": [0.5, 1.5, 2.5]},
    "benchmarks": [
      {"name": "a", "run_type": "iteration", "cpu_time": 3.0,
       "real_time": 6.0, "time_unit": "us", "calls": 2.0, "error": 0.25},
      {"name": "a", "run_type": "iteration", "cpu_time": 5.0,
       "real_time": 8.0, "time_unit": "us", "calls": 2.0, "error": 0.25},
      {"name": "a_mean", "run_type": "aggregate", "cpu_time": 4.0,
       "real_time": 7.0, "time_unit": "us"}]})"));
  EXPECT_THAT(results.load, ElementsAre(0.5));
  ASSERT_EQ(results.benchmarks.size(), 1u);
  const BenchmarkResult* a = results.Find("a");
  ASSERT_NE(a, nullptr);
  EXPECT_THAT(a->cpu_ns, ElementsAre(1500.0, 2500.0));
  EXPECT_THAT(a->real_ns, ElementsAre(3000.0, 4000.0));
  EXPECT_THAT(a->counters.at("error"), ElementsAre(0.25, 0.25));
  EXPECT_EQ(results.Find("b"), nullptr);
}

TEST_F(BenchmarkResultsTest, RejectsWhatIsNoResult) {
  for (const char* text :
       {"", "{}", "[1]", R"({"context": {"load_avg": []}, "benchmarks": []})",
        R"({"context": {"load_avg": [0]}, "benchmarks": [{"name": "a"}]})",
        R"({"context": {"load_avg": [0]}, "benchmarks": [{"name": "a",
            "run_type": "iteration", "time_unit": "h"}]})"}) {
    SCOPED_TRACE(text);
    const std::string path = Write(text);
    ExpectInputError([&] { BenchmarkResults().Read(path); }, {path});
  }
}

}  // namespace
}  // namespace rgbd_pose
