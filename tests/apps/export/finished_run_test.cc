#include <gtest/gtest.h>

#include "apps/export/export_format.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

// The noise (m) at a depth of 4 m in a cloud of a run with these settings, of a
// recording by a TUM RGB-D camera.
double NoiseOfCloudAt4M(const std::string& settings) {
  const TempFolder folder;
  const std::string recording = folder / "recording";
  for (const char* kind : {"rgb", "depth"}) {
    folder.Write(std::string("recording/") + kind + ".txt",
                 std::string("1.0 ") + kind + "/0.png\n");
    folder.Write(std::string("recording/") + kind + "/0.png", "");
  }
  folder.Write("run/frames.csv", "status,segment\nok,0\n");
  folder.Write("run/trajectory.txt", "1.0 0 0 0 0 0 0 1\n");
  folder.Write("run/config.flags", "# Input\n--dataset=" + recording +
                                       "\n--camera=tum_fr1\n" + settings);
  const FinishedRun run(folder / "run");
  return FusionOf<FusionOptions>(OpenRecording(run)->camera(), run, {})
      .depth.noise.sigma(4.0);
}

TEST(FinishedRunTest, ACloudHasTheDepthNoiseThatTrackingHad) {
  constexpr double kinect = 0.0008 + 0.0029 * 16.0;
  EXPECT_DOUBLE_EQ(NoiseOfCloudAt4M(""), kinect);
  EXPECT_DOUBLE_EQ(NoiseOfCloudAt4M("--depth_noise=camera\n"), kinect);
  EXPECT_DOUBLE_EQ(NoiseOfCloudAt4M("--depth_noise=constant\n"), 0.005);
}

}  // namespace
}  // namespace rgbd_pose
