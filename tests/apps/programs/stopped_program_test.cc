// Programs that are stopped by a signal: what they keep and what they leave.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "core/util/text_file.h"
#include "tests/support/program_test.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kFrames = 8;
constexpr int kStopAt = 4;  // the frame that is being read then

// A recording that waits for its depth image `kStopAt` like a camera: a pipe.
class StoppedProgramTest : public ProgramTest {
 protected:
  StoppedProgramTest() {
    const std::string camera = folder_.Write(
        "tiny.yaml",
        "Camera.fx: 131\nCamera.fy: 131\nCamera.cx: 79.5\nCamera.cy: 59.5\n"
        "Camera.width: 160\nCamera.height: 120\n");
    Render("camera",
           "--frames=" + std::to_string(kFrames) + " --camera=" + camera);
    fs::path stalled;
    int index = 0;
    for (const TextLine& line : ReadTextTable(folder_ / "camera/depth.txt")) {
      if (index++ == kStopAt) stalled = folder_ / ("camera/" + line.words[1]);
    }
    pipe_ = stalled.string();
    fs::rename(stalled, folder_ / "image.png");
    EXPECT_EQ(mkfifo(pipe_.c_str(), 0600), 0);
  }

  // Runs a program. When a condition holds, which is a shell command, another
  // one sends signals to process $id; then the camera goes on.
  RunResult RunUntil(const std::string& condition, const std::string& signal,
                     const std::string& program) const {
    std::signal(SIGINT, SIG_DFL);  // a test in the background ignores SIGINT
    const std::string command =
        "{ id=$$; tries=0; ( until " + condition +
        " || [ $((tries=tries+1)) = 1000 ]; do sleep 0.01; done; " + signal +
        "; timeout 20 cp '" + folder_ / "image.png" + "' '" + pipe_ +
        "' ) >/dev/null 2>&1 & exec " + program + " ; }";
    return Run(command);
  }

  // When all frames before the stalled one are written.
  RunResult ConvertUntil(const std::string& signal) const {
    return RunUntil("[ $(cat '" + folder_ / "out.rgbd_convert.partial/rgb.txt" +
                        "' | wc -l) -ge " + std::to_string(kStopAt) + " ]",
                    signal, Convert());
  }

  std::string Convert() const {
    return RGBD_CONVERT " --threads=1 --dataset=" + folder_ / "camera" +
           " --output=" + folder_ / "out";
  }

  // What a reader of the recording says, which needs its camera.
  std::string ReadBack(const std::string& name) const {
    const RunResult run =
        Run(RGBD_ODOMETRY " --validate_only --dataset=" + folder_ / name +
            " --camera=" + folder_ / (name + "/camera.yaml"));
    return run.out + run.err;
  }

  std::string pipe_;
};

TEST_F(StoppedProgramTest, ASignalEndsItWithWhatThereIs) {
  for (const std::string name : {"INT", "TERM", "HUP"}) {
    const RunResult run = ConvertUntil("kill -" + name + " $id");
    EXPECT_EQ(run.exit_code, 6) << run.err;
    EXPECT_THAT(run.err, HasSubstr("stopped after 5 frames (SIG" + name + ")"));
    EXPECT_FALSE(fs::exists(folder_ / "out.rgbd_convert.partial"));
    EXPECT_TRUE(fs::exists(folder_ / "out/groundtruth.txt"));
    EXPECT_THAT(ReadBack("out"), HasSubstr("frames      5, all readable"));

    // The next run of the same name leaves it alone.
    const RunResult next = Run(Convert());
    EXPECT_EQ(next.exit_code, 2);
    EXPECT_THAT(next.err, HasSubstr("is not an empty folder"));
    EXPECT_THAT(ReadBack("out"), HasSubstr("frames      5, all readable"));
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(StoppedProgramTest, WhatAKilledOneRecordedIsNotOverwritten) {
  EXPECT_NE(ConvertUntil("kill -KILL $id; exit").exit_code, 6);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  const RunResult next = Run(Convert());
  EXPECT_EQ(next.exit_code, 2);
  EXPECT_THAT(
      next.err,
      HasSubstr("out.rgbd_convert.partial holds what a killed program"));
  fs::rename(folder_ / "out.rgbd_convert.partial", folder_ / "kept");
  EXPECT_THAT(ReadBack("kept"), HasSubstr("frames      4, all readable"));
}

TEST_F(StoppedProgramTest, OneThatEndsAtOnceLeavesNothingUnfinished) {
  const std::string words = " --threads=1 --dataset=" + folder_ / "camera" +
                            " --output=" + folder_ / "out";
  const std::string unfinished = folder_ / "out/.rgbd_odometry.partial";
  for (const std::string& program :
       {RGBD_CALIBRATE + words,
        RGBD_ODOMETRY " --nofinish_on_signal" + words}) {
    for (const std::string name : {"INT", "TERM", "HUP"}) {
      const RunResult run = RunUntil("[ -d '" + unfinished + "' ]",
                                     "kill -" + name + " $id; exit", program);
      EXPECT_EQ(run.exit_code, -1) << "not ended by the signal";
      EXPECT_EQ(run.err, "");
      EXPECT_FALSE(fs::exists(folder_ / "out")) << program;
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
