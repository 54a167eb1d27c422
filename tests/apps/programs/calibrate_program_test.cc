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
#include "tests/support/program_test.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kCalibrateProgram = RGBD_CALIBRATE;
const std::string kSlamWithCalibration = RGBD_SLAM;

class CalibrateProgramTest : public ProgramTest {
 protected:
  CalibrateProgramTest() {
    Render("sequence", "--path=handheld --frames=40 --camera=ros_default");
    std::string camera = Read("sequence/camera.yaml");
    for (size_t at; (at = camera.find("525")) != std::string::npos;) {
      camera.replace(at, 3, "535.5");
    }
    folder_.Write("wrong.yaml", camera);
  }

  std::string Sequence() const { return folder_ / "sequence"; }
  RunResult Calibrate(const std::string& program, const std::string& output,
                      const std::string& flags) const {
    return Run(program + " --dataset=" + Sequence() +
               " --groundtruth=none --output=" + (folder_ / output) + " " +
               flags);
  }
  std::string Wrong() const { return "--camera=" + (folder_ / "wrong.yaml"); }
  // Without plotly.js, no page is written.
  void ExpectDrawn(const std::string& page, int plots) const {
    if (!Exists(page) || !HasBrowser()) return;
    const RunResult browser =
        Browse(folder_ / page, "--window-size=1280,4000 --dump-dom", folder_);
    EXPECT_EQ(Console(browser), "");
    EXPECT_THAT(browser.out, HasSubstr("data-done=\"true\""));
    EXPECT_EQ(CountOf(" js-plotly-plot\"", browser.out), plots);
  }
  bool Exists(const std::string& file) const {
    return fs::exists(folder_ / file);
  }
};

TEST_F(CalibrateProgramTest, FindsAWrongCameraAndKeepsARightOne) {
  // A damaged image costs only its own frame.
  fs::resize_file(Sequence() + "/depth/1000.666667.png", 1000);
  const RunResult wrong =
      Calibrate(kCalibrateProgram, "wrong", "--max_views=5000 " + Wrong());
  EXPECT_EQ(wrong.exit_code, 0) << wrong.out << wrong.err;
  EXPECT_THAT(wrong.out, HasSubstr("the new camera is better"));
  for (const char* file : {"camera.yaml", "depth_noise.yaml", "metrics.json",
                           "residuals.csv", "config.flags"}) {
    EXPECT_TRUE(Exists("wrong/" + std::string(file))) << file;
  }
  ExpectDrawn("wrong/report.html", 6);
  const auto metrics = nlohmann::json::parse(Read("wrong/metrics.json"));
  EXPECT_TRUE(metrics["calibration"]["accepted"]);
  EXPECT_EQ(metrics["damaged_frames"], 1);
  EXPECT_THAT(Read("wrong/camera.yaml"), HasSubstr("\ndepth_noise: ["));
  EXPECT_THAT(wrong.err, HasSubstr("1000.666667.png"));

  // Calibrating once more with the camera found changes nothing.
  const RunResult right =
      Calibrate(kCalibrateProgram, "right",
                "--noreport --max_views=5000 --camera=" +
                    (folder_ / "wrong/camera.yaml") +
                    " --depth_noise=" + (folder_ / "wrong/depth_noise.yaml"));
  EXPECT_EQ(right.exit_code, 5) << right.out << right.err;
  EXPECT_THAT(right.out, HasSubstr("the first camera is kept: "));
  EXPECT_EQ(Read("wrong/camera.yaml"), Read("right/camera.yaml"));
  EXPECT_FALSE(Exists("right/report.html"));
}

TEST_F(CalibrateProgramTest, SlamGoesOnWithTheCameraFound) {
  const RunResult both =
      Calibrate(kSlamWithCalibration, "both", Wrong() + " --calibrate");
  ASSERT_EQ(both.exit_code, 0) << both.out << both.err;
  EXPECT_THAT(both.out, HasSubstr("the new camera is better"));
  EXPECT_TRUE(Exists("both/calibration.html"));
  EXPECT_TRUE(Exists("both/depth_noise.yaml"));
  const auto metrics = nlohmann::json::parse(Read("both/metrics.json"));
  EXPECT_TRUE(metrics["calibration"]["accepted"]);
  EXPECT_TRUE(metrics.contains("slam"));
  // The settings written are those of a run with the new camera.
  const std::string flags = Read("both/config.flags");
  EXPECT_THAT(flags, HasSubstr("--camera=" + (folder_ / "both/camera.yaml")));
  const RunResult again = Run(kSlamWithCalibration +
                              " --flagfile=" + (folder_ / "both/config.flags") +
                              " --output=" + (folder_ / "again"));
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
  const std::string kCalibrate =
      kCalibrateProgram +
      " --dataset={seq} --camera={seq}/camera.yaml --output={dir}/out ";
  ExpectRefused(
      kCalibrate,
      {
          {"--fix=size",
           "fix: unknown parameter 'size'; available: focal, centre"},
          {"--output={seq}",
           "--output={seq}: is in the recording's own folder {seq}"},
          {"--known_length=1.5",
           "known_length: must be T0,T1,METRES, not '1.5'"},
          {"--determined_share=2",
           "determined_share must be above 0 and at most 1"},
          {"--max_passes=0", "max_passes must be 1"},
          {"--max_rate=nan", "max_rate must not be"},
          {"--max_halves_sigmas=-1", "max_halves_sigmas must be positive"},
          {"--depth_noise=a.yaml",
           "unknown depth noise 'a.yaml': no such file"},
      });
  ExpectRefused(kCalibrate,
                {{"--depth_noise={seq}/noise.yaml",
                  "{seq}/noise.yaml: sigma(z) = constant"}},
                [](const SpoiledSequence& s) {
                  s.Write("noise.yaml", "constant: 0\nquadratic: 0\n");
                });
}

}  // namespace
}  // namespace rgbd_pose
