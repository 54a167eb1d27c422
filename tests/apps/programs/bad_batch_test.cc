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

TEST_F(BadInputTest, BatchLists) {
  const std::string kList = "{seq}/list.txt";
  ExpectEach(
      kBadBatch,
      {
          {"no list", nullptr, "--sequences=", 1, "--sequences is needed"},
          {"no output", List(".\n"), "--output=", 1, "--output is needed"},
          {"missing", nullptr, "", 2, kList + ": cannot be opened"},
          {"empty", List("# nothing\n"), "", 2, kList + ": lists no sequences"},
          {"no such folder", List(".\nnone\n"), "", 2,
           kList + ":2: no such folder: none"},
          {"a pattern that nothing matches", List("no*\n"), "", 2,
           kList + ":1: no such folder: no*"},
          {"a file", List("rgb.txt\n"), "", 2, kList + ":1: no such folder"},
          {"twice", List("../seq\n../seq\n"), "", 2,
           kList + ":2: sequence name 'seq' is already used in line 1"},
          {"three columns", List(". tum_fr1 x\n"), "", 2,
           kList + ":1: needs one or two columns (folder camera), has 3"},
          {"no camera", List(". none.yaml\n"), "", 2,
           kList + ":1: no camera: {seq}/none.yaml is not a file"},
          {"a name that begins with a dot",
           [](const Seq& s) {
             fs::create_directory(s / ".hidden");
             s.Write("list.txt", ".hidden tum_fr1\n");
           },
           "", 2, kList + ":1: '.hidden' is not a valid name"},
      });
}

TEST_F(BadInputTest, BatchFlags) {
  const auto list = List("../seq\n");
  ExpectEach(
      kBadBatch,
      {
          {"a setting that has a list",
           [](const Seq& seq) {
             seq.Write("list.txt", "../seq\n");
             seq.Write("set.flags",
                       "# mine\n--depth_noise=kinect\n"
                       "--loss=huber\n");
           },
           "--settings={seq}/set.flags", 2,
           "{seq}/set.flags:3: --loss cannot be set for all runs; use "
           "--losses"},
          {"cost", list, "--costs=magic", 2,
           "--costs: unknown name 'magic'; available: "},
          {"loss", list, "--losses=tukey,", 2, "--losses: unknown loss ''"},
          {"no width", list, "'--losses=huber(1),huber()'", 2,
           "--losses: loss 'huber()': the width must be"},
          {"a loss twice", list, "--losses=tukey,tukey", 2,
           "--losses: 'tukey' appears twice"},
          {"frontend", list, "--frontends=magic", 2, "--frontends: unknown"},
          {"no repeats", list, "--repeats=0", 2,
           "--repeats must be 1 to 10000"},
          {"far too many repeats", list, "--repeats=2000000000", 2,
           "--repeats must be 1 to 10000"},
          {"negative jobs", list, "--jobs=-1", 2, "--jobs must be 0"},
          {"negative timeout", list, "--timeout=-1", 2, "--timeout must be 0"},
          {"no timeout", list, "--timeout=nan", 2, "--timeout must be 0"},
          {"shard beyond the last", list, "--shard=2/2", 2,
           "--shard=2/2: must be i/n with i from 0 to n - 1"},
          {"shard of none", list, "--shard=0/0", 2, "--shard=0/0: must be i/n"},
          {"negative shard", list, "--shard=-1/2", 2, "--shard=-1/2: must be"},
          {"no shard", list, "--shard=half", 2, "--shard=half: must be i/n"},
          {"merge and resume", list, "--merge --resume", 2,
           "--merge cannot be combined with --shard or --resume"},
          {"merge and shard", list, "--merge --shard=0/2", 2, "--merge cannot"},
          {"no settings", list, "--settings={seq}/none", 2,
           "{seq}/none: cannot be opened"},
          {"no program", list, "--program={seq}/none", 2,
           "{seq}/none: not an executable program"},
          {"a program that cannot be run", list, "--program={seq}/rgb.txt", 2,
           "{seq}/rgb.txt: not an executable program"},
      });
}

TEST_F(BadInputTest, BatchRuns) {
  const auto list = List("../seq\n");
  const std::string kRun = "out/seq/bidirectional_point-tukey-patch-hybrid-r1/";
  const auto call = [&](const std::string& words) {
    return RunCommand(Fill(kBadBatch) + words, folder_);
  };
  fs::copy(folder_ / "good", folder_ / "seq", fs::copy_options::recursive);
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
  fs::copy(folder_ / "good", folder_ / "seq", fs::copy_options::recursive);
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
