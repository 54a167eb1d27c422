// rgbd_batch from end to end: plans, failures, kills, shards.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/util/text_file.h"
#include "tests/support/program_test.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kBatch = RGBD_BATCH;
const std::string kOdometry = RGBD_ODOMETRY;

// Number of timing columns at the end of each line.
constexpr int kFrameTimes = 6;
constexpr int kSummaryTimes = 2;

std::string WithoutColumns(const std::string& csv, int columns) {
  std::istringstream lines(csv);
  std::string line, result;
  while (std::getline(lines, line)) {
    for (int i = 0; i < columns; ++i) line.erase(line.rfind(','));
    result += line + "\n";
  }
  return result;
}

int CountLines(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

// All files of a folder by relative path, without the parts that depend on when
// and how fast the files were made.
std::map<std::string, std::string> TimelessFiles(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = entry.path().filename().string();
    std::string text = ReadTextFile(entry.path().string());
    if (name == "frames.csv") text = WithoutColumns(text, kFrameTimes);
    if (name == "summary.csv") text = WithoutColumns(text, kSummaryTimes);
    if (name == "summary.json") {
      auto json = nlohmann::ordered_json::parse(text);
      for (auto& row : json) {
        row.erase("track_ms_median");
        row.erase("wall_seconds");
      }
      text = json.dump();
    }
    if (name == "metrics.json") {
      text = nlohmann::json::parse(text).at("evaluation").dump();
    }
    if (name == "run.log") text.clear();
    files[fs::relative(entry.path(), folder).string()] = text;
  }
  return files;
}

class BatchProgramTest : public ProgramTest {
 protected:
  // Two sequences small enough to be tracked very quickly.
  BatchProgramTest() {
    Render("data/xyz", "--frames=6 --path=xyz");
    Render("data/pan_tilt", "--frames=6 --path=pan_tilt");
    folder_.Write("list.txt", "data/xyz\ndata/pan_tilt\n");
    // Replaces the odometry: exits in the way given by the sequence's name.
    folder_.Write("program.sh",
                  "#!/bin/sh\ncase \"$*\" in\n"
                  "*data/slow*) exec sleep 1000 ;;\n"
                  "*data/crash*) kill -SEGV $$ ;;\n"
                  "*) exec '" +
                      kOdometry + "' \"$@\" ;;\nesac\n");
    fs::permissions(folder_ / "program.sh", fs::perms::owner_all);
  }

  // Makes an alias of a sequence.
  void Link(const std::string& name) const {
    fs::create_directory_symlink("xyz", folder_ / ("data/" + name));
  }

  // The command for 8 runs, two at a time, however many cores there are.
  std::string Call(const std::string& output,
                   const std::string& list = "list.txt") const {
    return kBatch + " --sequences=" + (folder_ / list) +
           " --losses=huber,tukey --repeats=2 --jobs=2 --output=" +
           (folder_ / output);
  }

  std::string FakeProgram() const {
    return " --program=" + (folder_ / "program.sh");
  }

  // A column of OUTPUT/<file>, without its header.
  std::vector<std::string> Column(const std::string& file,
                                  size_t column) const {
    std::istringstream lines(Read(file));
    std::string line;
    std::getline(lines, line);
    std::vector<std::string> cells;
    while (std::getline(lines, line)) {
      std::istringstream row(line);
      std::string cell;
      for (size_t i = 0; i <= column; ++i) std::getline(row, cell, ',');
      cells.push_back(cell);
    }
    return cells;
  }
};

constexpr size_t kStatus = 7;
constexpr size_t kExitCode = 8;

TEST_F(BatchProgramTest, ProgramsBesideItHaveNames) {
  const RunResult slam =
      Run(kBatch + " --sequences=" + (folder_ / "list.txt") +
          " --program=rgbd_slam --output=" + (folder_ / "runs"));
  EXPECT_EQ(slam.exit_code, 0) << slam.err;
  EXPECT_THAT(Column("runs/summary.csv", kStatus), ElementsAre("ok", "ok"));
  const std::string run = "runs/xyz/bidirectional_point-tukey-patch-hybrid-r1/";
  EXPECT_THAT(Read(run + "metrics.json"), HasSubstr("\"graph_keyframes\""));
  EXPECT_THAT(Read(run + "graph.g2o"), StartsWith("VERTEX_SE3:QUAT 0 "));

  const RunResult none =
      Run(kBatch + " --sequences=" + (folder_ / "list.txt") +
          " --program=rgbd_none --output=" + (folder_ / "none"));
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("rgbd_none: not an executable program"));
}

TEST_F(BatchProgramTest, RunsThePlanAndWhatIsMissingOfItLater) {
  const RunResult dry = Run(Call("runs") + " --dry_run");
  EXPECT_EQ(dry.exit_code, 0);
  EXPECT_THAT(dry.out, HasSubstr("8 runs, 8 of them to do"));
  EXPECT_FALSE(fs::exists(folder_ / "runs"));

  const RunResult first = Run(Call("runs"));
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.err, HasSubstr("[8/8] ok"));
  EXPECT_EQ(CountLines(first.err), 8);
  EXPECT_THAT(first.out, HasSubstr("8 runs, 0 not ok"));
  const std::string csv = Read("runs/summary.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "sequence,cost,loss,frontend,tracker,part,repeat,status,exit_code,"
            "folder,frames,ok,degraded,lost,tracked_share,ate_rmse_m,rpe_"
            "seconds_translation_m,"
            "rpe_seconds_rotation_deg,final_translation_m,final_rotation_deg,"
            "track_ms_median,wall_seconds");
  EXPECT_THAT(Column("runs/summary.csv", 0),
              ElementsAre("xyz", "xyz", "xyz", "xyz", "pan_tilt", "pan_tilt",
                          "pan_tilt", "pan_tilt"));
  EXPECT_THAT(csv,
              HasSubstr("\nxyz,bidirectional_point,huber,patch,hybrid,,1,ok,0,"
                        "xyz/bidirectional_point-huber-patch-hybrid-r1,6,"));
  EXPECT_EQ(nlohmann::json::parse(Read("runs/summary.json")).size(), 8u);

  const auto before = TimelessFiles(folder_ / "runs");
  const std::string run = "xyz/bidirectional_point-tukey-patch-hybrid-r";
  for (const std::string file :
       {"trajectory.txt", "frames.csv", "metrics.json", "config.flags"}) {
    ASSERT_EQ(before.count(run + "1/" + file), 1u) << file;
    EXPECT_EQ(before.at(run + "1/" + file), before.at(run + "2/" + file));
  }

  const RunResult refused = Run(Call("runs"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(CountLines(refused.err), 1);
  EXPECT_THAT(refused.err, HasSubstr("--resume"));

  fs::remove_all(folder_ / ("runs/" + run + "2"));
  const RunResult resumed = Run(Call("runs") + " --resume");
  EXPECT_EQ(resumed.exit_code, 0);
  EXPECT_THAT(resumed.err, AllOf(StartsWith("[1/1] ok"), HasSubstr(run + "2")));
  EXPECT_TRUE(TimelessFiles(folder_ / "runs") == before);
  EXPECT_EQ(Run(Call("runs") + " --resume").err, "") << "nothing to do";
  fs::remove(folder_ / ("runs/" + run + "1/metrics.json"));
  EXPECT_EQ(CountLines(Run(Call("runs") + " --resume").err), 1)
      << "a run without its results is repeated";

  // Another camera changes the hash of the inputs, so these runs are repeated.
  folder_.Write("data/xyz/camera.yaml", Read("data/xyz/camera.yaml") + "\n");
  EXPECT_EQ(CountLines(Run(Call("runs") + " --resume").err), 4);
}

TEST_F(BatchProgramTest, AChangedProgramRepeatsItsRuns) {
  const std::string call = kBatch + " --sequences=" + (folder_ / "list.txt") +
                           " --output=" + (folder_ / "runs") + FakeProgram();
  ASSERT_EQ(Run(call).exit_code, 0);
  EXPECT_THAT(Run(call + " --dry_run").out, HasSubstr("2 runs, 0 of them to"));
  folder_.Write("program.sh", Read("program.sh") + "# a later version\n");
  fs::permissions(folder_ / "program.sh", fs::perms::owner_all);
  EXPECT_THAT(Run(call + " --dry_run").out, HasSubstr("2 runs, 2 of them to"));
  EXPECT_EQ(CountLines(Run(call + " --resume").err), 2);
}

TEST_F(BatchProgramTest, OneThatFailsDoesNotStopTheOthers) {
  Link("slow");
  Link("crash");
  fs::copy(folder_ / "data/xyz", folder_ / "data/broken",
           fs::copy_options::recursive);
  for (const auto& depth :
       fs::directory_iterator(folder_ / "data/broken/depth")) {
    fs::resize_file(depth.path(), 100);
  }
  folder_.Write("bad.txt",
                "data/slow\ndata/crash\ndata/broken\ndata/pan_tilt\n");
  const std::string call =
      kBatch + " --sequences=" + (folder_ / "bad.txt") +
      " --jobs=2 --timeout=3 --output=" + (folder_ / "runs") + FakeProgram();
  const RunResult run = Run(call);
  EXPECT_EQ(run.exit_code, 4);
  EXPECT_THAT(Column("runs/summary.csv", kStatus),
              ElementsAre("timeout", "crashed", "failed", "ok"));
  EXPECT_THAT(Column("runs/summary.csv", kExitCode),
              ElementsAre("137", "139", "2", "0"));
  EXPECT_THAT(run.err, HasSubstr("timeout (exit code 137)  slow/"));
  EXPECT_THAT(run.out, HasSubstr("4 runs, 3 not ok"));
  EXPECT_THAT(
      Read("runs/broken/bidirectional_point-tukey-patch-hybrid-r1/run.log"),
      HasSubstr(".png"));

  // Failed runs are repeated.
  EXPECT_EQ(Run(call + " --resume").exit_code, 4);
  fs::remove(folder_ / "data/slow");
  fs::remove(folder_ / "data/crash");
  folder_.Write("bad.txt", "data/broken\ndata/pan_tilt\n");
  fs::remove_all(folder_ / "data/broken");
  fs::copy(folder_ / "data/xyz", folder_ / "data/broken",
           fs::copy_options::recursive);
  const RunResult mended = Run(call + " --resume");
  EXPECT_EQ(mended.exit_code, 0);
  EXPECT_THAT(mended.err, StartsWith("[1/1] ok  broken/"));
}

TEST_F(BatchProgramTest, AKilledBatchIsResumedToTheSameResults) {
  ASSERT_EQ(Run(Call("undisturbed")).exit_code, 0);
  for (const std::string seconds : {"0.05", "0.11", "0.23"}) {
    Run("(" + Call("killed") + " --resume & pid=$!; sleep " + seconds +
        "; kill -9 $pid)");
  }
  const RunResult resumed = Run(Call("killed") + " --resume");
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_TRUE(TimelessFiles(folder_ / "killed") ==
              TimelessFiles(folder_ / "undisturbed"));
}

TEST_F(BatchProgramTest, OnlyOneWorksOnAFolder) {
  Link("slow");
  folder_.Write("slow.txt", "data/slow\n");
  const std::string slow = Call("runs", "slow.txt") + FakeProgram();
  const std::string other = Call("runs") + " --resume";
  const std::string errors = folder_ / "second";
  // The second call comes while the first one's runs go on. The third gets the
  // folder as soon as the first is killed, hence its runs have ended, too.
  const RunResult run =
      Run("(" + slow + " & pid=$!; for i in $(seq 500); do [ -e " +
          (folder_ / "runs/slow/*-r1.partial/run.log") +
          " ] && break; sleep 0.02; done; " + other + " 2>" + errors +
          "; echo exit $?; kill -9 $pid; " + other + " >&2; echo exit $?)");
  EXPECT_EQ(run.out, "exit 2\nexit 0\n") << run.err;
  EXPECT_EQ(CountLines(ReadTextFile(errors)), 1);
  EXPECT_THAT(ReadTextFile(errors), HasSubstr("locked by another rgbd_batch"));
}

// Some daemons start programs so.
TEST_F(BatchProgramTest, EndsWhereSignalsOfChildrenAreIgnored) {
  const RunResult run =
      Run("timeout 100 env --ignore-signal=CHLD " + Call("runs"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST_F(BatchProgramTest, ShardsMergeToTheSummaryOfOneBatch) {
  ASSERT_EQ(Run(Call("local")).exit_code, 0);
  ASSERT_EQ(Run(Call("shards") + " --shard=0/2").exit_code, 0);
  EXPECT_EQ(Column("shards/summary-0-of-2.csv", 0),
            std::vector<std::string>(4, "xyz"));
  EXPECT_FALSE(fs::exists(folder_ / "shards/summary.csv"));

  const std::string merge = Call("shards") + " --merge";
  EXPECT_EQ(Run(merge).exit_code, 4) << "half is missing";
  EXPECT_THAT(Column("shards/summary.csv", kStatus),
              ElementsAre("ok", "ok", "ok", "ok", "missing", "missing",
                          "missing", "missing"));

  const RunResult second =
      Run("SLURM_ARRAY_TASK_ID=4 SLURM_ARRAY_TASK_COUNT=2 "
          "SLURM_ARRAY_TASK_MIN=3 " +
          Call("shards"));
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(Run(merge).exit_code, 0);
  auto merged = TimelessFiles(folder_ / "shards");
  for (const std::string shard : {"0-of-2", "1-of-2"}) {
    EXPECT_EQ(merged.erase("summary-" + shard + ".csv"), 1u);
    EXPECT_EQ(merged.erase(".lock-" + shard), 1u);
  }
  EXPECT_TRUE(merged == TimelessFiles(folder_ / "local"));
}

}  // namespace
}  // namespace rgbd_pose
