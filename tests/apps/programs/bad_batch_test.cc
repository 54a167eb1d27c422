// Wrong lists, grids, shards and folders of a batch.

#include "core/util/text_file.h"
#include "tests/support/bad_input.h"

namespace rgbd_pose {
namespace {

using Seq = SpoiledSequence;
namespace fs = std::filesystem;

auto List(const std::string& text) {
  return [=](const Seq& seq) { seq.Write("list.txt", text); };
}

const std::string kBadBatch =
    RGBD_BATCH " --sequences={seq}/list.txt --output={dir}/out ";

// What else may be wrong in a list or a grid is tested where these are read.
TEST_F(BadInputTest, BatchLists) {
  const std::string kList = "{seq}/list.txt";
  ExpectNeeded(kBadBatch, {"--sequences"});
  ExpectEach(
      kBadBatch,
      {
          {"no output", List(".\n"), "--output=", 1, "--output is needed"},
          {"missing", nullptr, "", 2, kList + ": cannot be opened"},
          {"no such folder", List(".\nnone\n"), "", 2,
           kList + ":2: no such folder: none"},
          {"no camera", List(". none.yaml\n"), "", 2,
           kList + ":1: no camera: {seq}/none.yaml is not a file"},
      });
}

TEST_F(BadInputTest, BatchFlags) {
  const auto list = List("../seq\n");
  const std::string kRepeats = "--repeats must be 1 to 10000";
  const std::string kMerge =
      "--merge cannot be combined with --shard or --resume";
  ExpectRefused(
      kBadBatch,
      {
          {"--costs=magic", "--costs: unknown name 'magic'; available: "},
          {"'--losses=huber(1),huber()'",
           "--losses: loss 'huber()': the width must be"},
          {"--losses=tukey,tukey", "--losses: 'tukey' appears twice"},
          {"--repeats=0", kRepeats},
          {"--repeats=2000000000", kRepeats},
          {"--jobs=-1", "--jobs must be 0"},
          {"--timeout=-1", "--timeout must be 0"},
          {"--timeout=nan", "--timeout must be 0"},
          {"--shard=2/2", "--shard=2/2: must be i/n with i from 0 to n - 1"},
          {"--merge --resume", kMerge},
          {"--merge --shard=0/2", kMerge},
          {"--settings={seq}/none", "{seq}/none: cannot be opened"},
          {"--program={seq}/none", "{seq}/none: not an executable program"},
          {"--program={seq}/rgb.txt",
           "{seq}/rgb.txt: not an executable program"},
      },
      list);
  const std::pair<const char*, const char*> kForAll[] = {
      {"--loss=huber", "--loss cannot be set for all runs; use --losses"},
      {"-loss=huber", "--loss cannot be set for all runs; use --losses"},
      {"--output=x", "--output cannot be set for all runs; each has its own"},
      {"--save_mesh=/tmp/mesh.ply",
       "--save_mesh: each run would replace that of the run before; give a "
       "relative path"}};
  for (const auto& [flag, message] : kForAll) {
    const std::string text =
        std::string("# mine\n--depth_noise=kinect\n") + flag + "\n";
    ExpectRefused(kBadBatch,
                  {{"--settings={seq}/set.flags",
                    std::string("{seq}/set.flags:3: ") + message}},
                  [&](const Seq& seq) {
                    list(seq);
                    seq.Write("set.flags", text);
                  });
  }
}

TEST_F(BadInputTest, BatchRuns) {
  const auto list = List("../seq\n");
  const std::string kRun = "out/seq/bidirectional_point-tukey-patch-hybrid-r1/";
  const auto call = [&](const std::string& words) {
    return RunCommand(Fill(kBadBatch) + words, folder_);
  };
  Renew();
  list(Spoiled());
  ASSERT_EQ(call("").exit_code, 0);

  // With a damaged marker the run counts as not done.
  const std::string marker = ReadTextFile(folder_ / (kRun + "done.json"));
  for (const std::string& content :
       {std::string(), marker.substr(0, marker.size() / 2),
        std::string("{\"status\": \"a,b\"}"), std::string("[]")}) {
    folder_.Write(kRun + "done.json", content);
    const RunResult refused = call("");
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, testing::HasSubstr("already contains runs"));
    EXPECT_EQ(call("--merge").exit_code, 4);
    const RunResult resumed = call("--resume");
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.err, testing::StartsWith("[1/1] ok"));
    EXPECT_EQ(ReadTextFile(folder_ / (kRun + "done.json")), marker);
  }

  // Invalid figures do not break the table's format.
  folder_.Write(kRun + "metrics.json", "{\"run\": {\"frames\": \"a,b\\n\"}}");
  ASSERT_EQ(call("--merge").exit_code, 0);
  const std::string table = ReadTextFile(folder_ / "out/summary.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 2);
  EXPECT_EQ(std::count(table.begin(), table.end(), ','), 2 * 21);
}

// Runs that cannot write their results fail and leave no complete results.
TEST_F(BadInputTest, BatchOnAFullDisk) {
  Renew();
  List("../seq\n")(Spoiled());
  const RunResult run =
      RunCommand("ulimit -f 3; exec " + Fill(kBadBatch), folder_);
  EXPECT_EQ(run.exit_code, 4) << run.err;
  const std::string kRun = "out/seq/bidirectional_point-tukey-patch-hybrid-r1/";
  EXPECT_THAT(ReadTextFile(folder_ / (kRun + "run.log")),
              testing::HasSubstr("metrics.json: writing failed (File too"));
  EXPECT_THAT(ReadTextFile(folder_ / (kRun + "done.json")),
              testing::HasSubstr("\"failed\""));
  EXPECT_FALSE(fs::exists(folder_ / (kRun + "metrics.json")));
}

}  // namespace
}  // namespace rgbd_pose
