// Outputs that cannot be written: below a file, on a full disk, in use.

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/util/text_file.h"
#include "tests/support/bad_input.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;
using Seq = SpoiledSequence;
using testing::HasSubstr;

const std::string kBadEvaluation = RGBD_EVALUATE
    " --estimate={seq}/groundtruth.txt --groundtruth={seq}/groundtruth.txt ";
const std::string kSweep = RGBD_COMPARE
    " --experiment=sweep --seeds=1 --losses=none,huber --output={dir}/out ";

// A full disk: writing fails once a file exceeds so many blocks of 512 bytes
// (1024 where sh is bash).
std::string WithFullDisk(int blocks, const std::string& command) {
  return "ulimit -f " + std::to_string(blocks) + "; exec " + command;
}

TEST_F(BadInputTest, OutputsThatCannotBe) {
  constexpr char kOwn[] = "is in the recording's own folder {seq}; choose one";
  ExpectRefused(
      Odometry(),
      {
          {"--output={dir}/small.yaml/out",
           "--output: {dir}/small.yaml/out cannot be created"},
          {"--output={dir}/small.yaml",
           "--output: {dir}/small.yaml cannot be created"},
          {"--output=/proc/none", "--output: /proc/none cannot be created"},
          {"--output={seq}", kOwn},
          {"--output={dir}/./seq/", kOwn},
          {"--output={seq}/runs/out", kOwn},
          {"--save_cloud={dir}/none/cloud.ply",
           "{dir}/none/cloud.ply: cannot be written (No such file"},
          {"--save_cloud={dir}",
           "{dir}: a point cloud needs the extension .ply"},
          {"--save_cloud={dir}/small.yaml",
           "{dir}/small.yaml: a point cloud needs the extension .ply"},
          {"--save_cloud={seq}/cloud.ply",
           "--save_cloud={seq}/cloud.ply: is in the recording's own folder"},
          {"--save_mesh={seq}/rgb/mesh.glb",
           "--save_mesh={seq}/rgb/mesh.glb: is in the recording's own folder"},
          {"--save_mesh={dir}/mesh.obj",
           "mesh.obj: the name of a mesh must end in one of .ply, .glb"},
          {"--min_depth=4.2 --save_mesh={dir}/mesh.ply",
           "--voxel or --max_depth: "},
          {"--save_cloud={dir}/a.ply --save_mesh={dir}/a.ply",
           "--save_cloud and --save_mesh are the same file"},
          {"--save_cloud={dir}/a.ply --save_mesh={dir}/./a.ply",
           "--save_cloud and --save_mesh are the same file"},
          {"--record={dir}/a.bag",
           "--record={dir}/a.bag: the name of a recording for ROS 2 must end "
           "in .mcap"},
          {"--record={dir}/none/a.mcap",
           "{dir}/none/a.mcap: cannot be written (No such file"},
          {"--record={seq}/a.mcap",
           "--record={seq}/a.mcap: is in the recording's own folder {seq}"},
      });
  ExpectEach(
      Odometry(),
      {
          {"beside the recording, with its name", nullptr, "--output={seq}_run",
           0, ""},
          {"the recording exists",
           [](const Seq& s) { s.Write("../mine.mcap", "mine"); },
           "--record={dir}/mine.mcap", 2,
           "{dir}/mine.mcap: exists; choose another name, or remove it"},
          {"the recording was left by a killed program",
           [](const Seq& s) { s.Write("../left.mcap.partial", "mine"); },
           "--record={dir}/left.mcap", 2,
           "{dir}/left.mcap.partial: another program is writing it, or a"},
      });
  // Of other programs, where there are a file and a list of sequences.
  const std::string kMany =
      "--json --rpe_frames="
      "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24";
  ExpectRefused(
      "",
      {
          {RGBD_SIMULATE " --frames=2 --output={seq}/file/out",
           "{seq}/file/out: cannot be written: Not a directory"},
          {RGBD_SIMULATE " --frames=2 --output={seq}",
           "{seq}: already exists and is not an empty folder"},
          // Names in the recording where it is the current folder.
          {"(cd {seq}; exec " RGBD_ODOMETRY " .)",
           "--output=runs/seq: is in the recording's own folder .; choose one"},
          {"(cd {seq}; exec " RGBD_ODOMETRY " . --output=new/out)",
           "--output=new/out: is in the recording's own folder ."},
          {RGBD_CONVERT " --dataset={seq} --output={seq}/out", kOwn},
          {RGBD_SLAM " --dataset={seq} --output={seq}/out", kOwn},
          {RGBD_CALIBRATE " --dataset={seq} --output={seq}/out", kOwn},
          {RGBD_COMPARE " --experiment={seq} --camera={seq}/camera.yaml "
                        "--output={seq}/out",
           kOwn},
          {kSweep + "--output={seq}/file/out",
           "--output={seq}/file/out: cannot be created (Not a directory)"},
          {RGBD_BATCH " --sequences={seq}/list --output={dir}/small.yaml/out",
           "--output={dir}/small.yaml/out: cannot be created (Not a dir"},
          {RGBD_BATCH " --sequences={seq}/list --output={seq}/out", kOwn},
          {kBadEvaluation + "--aligned={seq}/file/aligned.txt",
           "{seq}/file/aligned.txt: cannot be written (Not a directory)"},
          // Nobody takes the output, or more of it than a buffer holds.
          {"(exec >/dev/full; exec " + kBadEvaluation + ")",
           "the standard output cannot be written (No space left on device)"},
          {"(exec >/dev/full; exec " + kBadEvaluation + kMany + ")",
           "the standard output cannot be written"},
          {"(exec <&- >&-; exec " + kBadEvaluation + ")",
           "the standard output cannot be written (Bad file descriptor)"},
          {"(exec >/dev/full; exec " RGBD_EVALUATE " --help)",
           "the standard output cannot be written (No space left on device)"},
          {"(exec >/dev/full; exec " RGBD_EVALUATE " --version)",
           "the standard output cannot be written (No space left on device)"},
      },
      [](const Seq& s) {
        s.Write("file", "mine");
        s.Write("list", ".\n");
      });
}

TEST_F(BadInputTest, FullDisks) {
  ExpectEach(
      "", {
              {"figures", nullptr, WithFullDisk(2, Odometry()), 2,
               "edges.csv: writing failed (File too large)"},
              {"pictures", nullptr,
               WithFullDisk(40, Odometry() + "--debug_images=all"), 2,
               "debug/000000.png: writing failed (File too large)"},
              {"simulate", nullptr,
               WithFullDisk(40, RGBD_SIMULATE " --frames=2 --output={dir}/out"),
               2, ".png: writing failed (File too large)"},
              {"inertial samples",
               [](const Seq& s) {
                 s.Write("../tiny.yaml",
                         "Camera.fx: 65\nCamera.fy: 65\nCamera.cx: 40\n"
                         "Camera.cy: 30\nCamera.width: 80\n"
                         "Camera.height: 60\n");
               },
               WithFullDisk(60, RGBD_SIMULATE
                            " --frames=4 --camera={dir}/tiny.yaml --imu "
                            "--imu_rate=10000 --output={dir}/out"),
               2, "imu.csv: writing failed (File too large)"},
              {"compare", nullptr, WithFullDisk(2, kSweep), 2,
               "writing failed (File too large)"},
              {"evaluate",
               [](const Seq& s) {
                 std::string poses;
                 for (int i = 0; i < 100; ++i) {
                   poses += std::to_string(i) + " 0 0 0 0 0 0 1\n";
                 }
                 s.Write("groundtruth.txt", poses);
               },
               WithFullDisk(2, kBadEvaluation + "--aligned={dir}/aligned.txt"),
               2, "{dir}/aligned.txt: writing failed (File too large)"},
          });
}

#ifndef RGBD_POSE_SANITIZED
// Of OpenCV's images, and of others.
TEST_F(BadInputTest, TooLittleMemory) {
  constexpr char kSimulate[] =
      "ulimit -v 300000; exec " RGBD_SIMULATE " --output={dir}/out --frames=";
  constexpr char kMessage[] = "there is not enough memory; use larger voxels,";
  ExpectEach(
      kSimulate,
      {
          {"images",
           [](const Seq& s) {
             s.Write("huge.yaml",
                     "Camera.fx: 9000\nCamera.fy: 9000\n"
                     "Camera.cx: 6000\nCamera.cy: 6000\n"
                     "Camera.width: 12000\nCamera.height: 12000\n");
           },
           "1 --camera={seq}/huge.yaml", 2, kMessage},
          {"samples", nullptr, "1000000 --imu --imu_rate=1e5", 2, kMessage},
      });
}
#endif

std::string Contents(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    files.push_back(
        entry.path().string() + "\n" +
        (entry.is_regular_file() ? ReadTextFile(entry.path().string()) : ""));
  }
  std::sort(files.begin(), files.end());
  std::string text;
  for (const std::string& file : files) text += file;
  return text;
}

// A run that fails for any reason keeps the results of the previous run.
TEST_F(BadInputTest, ARunThatFailsLeavesEarlierResultsAlone) {
  fs::rename(folder_ / "good", folder_ / "seq");
  const std::string call = Fill(Odometry()) + "--debug_images=1 ";
  ASSERT_EQ(RunCommand(call, folder_).exit_code, 0);
  const std::string before = Contents(folder_ / "out");
  for (const std::string& command :
       {WithFullDisk(2, call), WithFullDisk(40, call),
        call + "--save_cloud=/dev/full/cloud.ply"}) {
    EXPECT_EQ(RunCommand(command, folder_).exit_code, 2);
    EXPECT_EQ(Contents(folder_ / "out"), before) << command;
  }
  Spoiled().Remove("depth");
  EXPECT_EQ(RunCommand(call, folder_).exit_code, 2);
  EXPECT_EQ(Contents(folder_ / "out"), before);
}

// What is large, and can be written later, costs nothing else: clouds and
// meshes, a recording, which makes room for the results, and the page.
TEST_F(BadInputTest, WhatDoesNotFitCostsNothingElse) {
  const struct {
    int blocks;
    const char* words;
    const char* named;
    std::vector<std::string> left_out;
  } kRows[] = {
      {40,
       "--save_cloud={dir}/cloud.ply --save_mesh={dir}/mesh.ply",
       ".ply",
       {"cloud.ply"}},
      {40, "--record={dir}/a.mcap", "a.mcap", {"a.mcap", "a.mcap.partial"}},
      {500, "--report", "report.html", {"out/report.html"}},
  };
  for (const auto& row : kRows) {
    SCOPED_TRACE(row.words);
    Renew();
    const RunResult run = RunCommand(
        WithFullDisk(row.blocks, Fill(Odometry() + row.words)), folder_);
    if (run.out.find("built without plotly.js") != std::string::npos) {
      GTEST_SKIP() << "built without plotly.js";  // the last row
    }
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr(row.named +
                                   std::string(": writing failed (File too "
                                               "large); all other results are "
                                               "in ")));
    for (const std::string& file : row.left_out) {
      EXPECT_FALSE(fs::exists(folder_ / file)) << file;
    }
    for (const char* name : {"trajectory.txt", "frames.csv", "metrics.json"}) {
      EXPECT_TRUE(fs::exists(folder_ / ("out/" + std::string(name)))) << name;
    }
  }
}

// Files of an earlier run that this run does not write are removed.
TEST_F(BadInputTest, ResultsAreThoseOfOneRun) {
  fs::rename(folder_ / "good", folder_ / "seq");
  const std::string call = Fill(Odometry());
  ASSERT_EQ(RunCommand(call + "--debug_images=0-1", folder_).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/errors.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/debug/000001.png"));
  folder_.Write("out/mine.txt", "mine");
  folder_.Write("out/slam.csv", "of rgbd_slam");
  folder_.Write("out/calibration.html", "of rgbd_slam --calibrate");
  folder_.Write("out/residuals.csv", "of rgbd_calibrate");
  folder_.Write("out/camera.yaml", "may be the camera of this run");
  folder_.Write("out/debug/000001_mine.png", "mine");
  Spoiled().Remove("groundtruth.txt");
  ASSERT_EQ(RunCommand(call, folder_).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/errors.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "out/slam.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "out/calibration.html"));
  EXPECT_FALSE(fs::exists(folder_ / "out/residuals.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/camera.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / "out/debug/000001.png"));
  EXPECT_TRUE(fs::exists(folder_ / "out/mine.txt"));
  EXPECT_TRUE(fs::exists(folder_ / "out/debug/000001_mine.png"));
}

TEST_F(BadInputTest, OneRunAtATimeWritesToAFolder) {
  fs::rename(folder_ / "good", folder_ / "seq");
  const std::string call = Fill(Odometry());
  const std::string staging_dir = "out/.rgbd_odometry.partial/";
  folder_.Write(staging_dir + "metrics.json", "of a run that was killed");
  const int lock =
      open((folder_ / staging_dir).c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  const RunResult refused = RunCommand(call, folder_);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("another program is writing its"));
  EXPECT_TRUE(fs::exists(folder_ / (staging_dir + "metrics.json")));
  close(lock);
  EXPECT_EQ(RunCommand(call, folder_).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / staging_dir));
  EXPECT_THAT(ReadTextFile(folder_ / "out/metrics.json"), HasSubstr("ate"));

  // Many runs at once: some may be refused, but the results are complete.
  const RunResult many = RunCommand("{ for i in 1 2 3 4 5 6; do (" + call +
                                        " >/dev/null; echo $?) & done; wait; }",
                                    folder_);
  EXPECT_THAT(many.out, testing::MatchesRegex("([02]\n)*0\n([02]\n)*"));
  EXPECT_FALSE(fs::exists(folder_ / staging_dir));
  EXPECT_THAT(ReadTextFile(folder_ / "out/metrics.json"), HasSubstr("ate"));
}

}  // namespace
}  // namespace rgbd_pose
