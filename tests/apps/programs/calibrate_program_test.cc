// rgbd_calibrate and rgbd_slam --calibrate from end to end, and bad input.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/evaluation/trajectory.h"
#include "core/util/text_file.h"
#include "tests/support/bad_input.h"
#include "tests/support/browser.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kCalibrateProgram = RGBD_CALIBRATE;
const std::string kSlamWithCalibration = RGBD_SLAM;

class CalibrateProgramTest : public testing::Test {
 protected:
  CalibrateProgramTest() {
    const RunResult run =
        RunCommand(std::string(RGBD_SIMULATE) +
                       " --path=handheld --frames=40 --output=" + Sequence(),
                   folder_);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    std::string camera = ReadTextFile(Sequence() + "/camera.yaml");
    for (size_t at; (at = camera.find("525")) != std::string::npos;) {
      camera.replace(at, 3, "535.5");
    }
    WriteFileAtomically(folder_ / "wrong.yaml", camera);
  }

  std::string Sequence() const { return folder_ / "sequence"; }
  RunResult Run(const std::string& program, const std::string& output,
                const std::string& flags) const {
    return RunCommand(program + " --dataset=" + Sequence() +
                          " --groundtruth=none --output=" + (folder_ / output) +
                          " " + flags,
                      folder_);
  }
  std::string Wrong() const { return "--camera=" + (folder_ / "wrong.yaml"); }
  // Without plotly.js, no page is written.
  void ExpectDrawn(const std::string& page, int plots) const {
    if (!Exists(page) || !HasBrowser()) return;
    const RunResult browser =
        Browse(folder_ / page, "--window-size=1280,4000 --dump-dom", folder_);
    EXPECT_EQ(Console(browser), "");
    EXPECT_THAT(browser.out, HasSubstr("data-done=\"true\""));
    int drawn = 0;
    for (size_t at = 0;
         (at = browser.out.find(" js-plotly-plot\"", at)) != std::string::npos;
         ++at) {
      ++drawn;
    }
    EXPECT_EQ(drawn, plots);
  }
  bool Exists(const std::string& file) const {
    return fs::exists(folder_ / file);
  }

  const TempFolder folder_;
};

TEST_F(CalibrateProgramTest, FindsAWrongCameraAndKeepsARightOne) {
  // A damaged image costs only its own frame.
  fs::resize_file(Sequence() + "/depth/1000.666667.png", 1000);
  const RunResult wrong =
      Run(kCalibrateProgram, "wrong", "--max_views=5000 " + Wrong());
  EXPECT_EQ(wrong.exit_code, 0) << wrong.out << wrong.err;
  EXPECT_THAT(wrong.out, HasSubstr("the new camera is better"));
  for (const char* file : {"camera.yaml", "depth_noise.yaml", "metrics.json",
                           "residuals.csv", "config.flags"}) {
    EXPECT_TRUE(Exists("wrong/" + std::string(file))) << file;
  }
  ExpectDrawn("wrong/report.html", 6);
  const auto metrics =
      nlohmann::json::parse(ReadTextFile(folder_ / "wrong/metrics.json"));
  EXPECT_TRUE(metrics["calibration"]["accepted"]);
  EXPECT_EQ(metrics["damaged_frames"], 1);
  EXPECT_THAT(ReadTextFile(folder_ / "wrong/camera.yaml"),
              HasSubstr("\ndepth_noise: ["));
  EXPECT_THAT(wrong.err, HasSubstr("1000.666667.png"));

  // Calibrating once more with the camera found changes nothing.
  const RunResult right =
      Run(kCalibrateProgram, "right",
          "--noreport --max_views=5000 --camera=" +
              (folder_ / "wrong/camera.yaml") +
              " --depth_noise=" + (folder_ / "wrong/depth_noise.yaml"));
  EXPECT_EQ(right.exit_code, 5) << right.out << right.err;
  EXPECT_THAT(right.out, HasSubstr("the first camera is kept: "));
  EXPECT_EQ(ReadTextFile(folder_ / "wrong/camera.yaml"),
            ReadTextFile(folder_ / "right/camera.yaml"));
  EXPECT_FALSE(Exists("right/report.html"));
}

TEST_F(CalibrateProgramTest, SlamGoesOnWithTheCameraFound) {
  const RunResult both =
      Run(kSlamWithCalibration, "both", Wrong() + " --calibrate");
  ASSERT_EQ(both.exit_code, 0) << both.out << both.err;
  EXPECT_THAT(both.out, HasSubstr("the new camera is better"));
  EXPECT_TRUE(Exists("both/calibration.html"));
  EXPECT_TRUE(Exists("both/depth_noise.yaml"));
  const auto metrics =
      nlohmann::json::parse(ReadTextFile(folder_ / "both/metrics.json"));
  EXPECT_TRUE(metrics["calibration"]["accepted"]);
  EXPECT_TRUE(metrics.contains("slam"));
  // The settings written are those of a run with the new camera.
  const std::string flags = ReadTextFile(folder_ / "both/config.flags");
  EXPECT_THAT(flags, HasSubstr("--camera=" + (folder_ / "both/camera.yaml")));
  const RunResult again = RunCommand(
      kSlamWithCalibration + " --flagfile=" + (folder_ / "both/config.flags") +
          " --output=" + (folder_ / "again"),
      folder_);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const Trajectory first = ReadTrajectory(folder_ / "both/trajectory.txt");
  const Trajectory second = ReadTrajectory(folder_ / "again/trajectory.txt");
  ASSERT_EQ(first.size(), second.size());
  for (size_t i = 0; i < first.size(); ++i) {
    // Numbers in the file are rounded.
    const Rigid3d moved =
        first[i].world_from_cam.Inverse() * second[i].world_from_cam;
    EXPECT_LT(moved.translation.norm(), 1e-5) << i;
  }
}

TEST_F(BadInputTest, OfCalibrations) {
  ExpectEach(
      kCalibrateProgram +
          " --dataset={seq} --camera={seq}/camera.yaml "
          "--output={dir}/out ",
      {
          {"a part that is not there", nullptr, "--fix=size", 2,
           "fix: unknown parameter 'size'; available: focal, centre"},
          {"the recording's own folder", nullptr, "--output={seq}", 2,
           "--output={seq}: is in the recording's own folder {seq}"},
          {"a length without times", nullptr, "--known_length=1.5", 2,
           "known_length: must be T0,T1,METRES, not '1.5'"},
          {"a share that is none", nullptr, "--determined_share=2", 2,
           "determined_share must be above 0 and at most 1"},
          {"no pass", nullptr, "--max_passes=0", 2, "max_passes must be 1"},
          {"no rate", nullptr, "--max_rate=nan", 2, "max_rate must not be"},
          {"halves", nullptr, "--max_halves_sigmas=-1", 2,
           "max_halves_sigmas must be positive"},
          {"a noise model that is not there", nullptr, "--depth_noise=a.yaml",
           2, "unknown depth noise 'a.yaml': no such file"},
          {"a noise model without noise",
           [](const SpoiledSequence& s) {
             s.Write("noise.yaml", "constant: 0\nquadratic: 0\n");
           },
           "--depth_noise={seq}/noise.yaml", 2,
           "{seq}/noise.yaml: sigma(z) = constant"},
      });
}

}  // namespace
}  // namespace rgbd_pose
