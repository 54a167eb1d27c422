// A real inertial sensor, if its data are available: what
// docs/examples/inertial_path.cc prints of both halves of a recording.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/util/text_file.h"
#include "tests/support/run_program.h"

namespace rgbd_pose {
namespace {

TEST(RealImuTest, PredictsPositionsToTheTrackersNoise) {
  const char* const data = std::getenv("RGBD_POSE_TEST_DATA");
  const std::string name = "euroc_mh01_imu";
  if (data == nullptr || !std::filesystem::exists(data + ("/" + name))) {
    GTEST_SKIP() << "needs " << name << " in RGBD_POSE_TEST_DATA";
  }
  const TempFolder folder;
  const RunResult run = RunCommand(
      RGBD_POSE_INERTIAL_PATH " '" + (data + ("/" + name)) + "'", folder);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // The values of a name, in both halves.
  const auto values = [&](const std::string& key) {
    std::vector<double> result;
    for (const TextLine& line : SplitTextTable(run.out)) {
      if (line.words.at(0) == key) {
        result.push_back(ParseNumber(line.words.at(1), "", line.number, key));
      }
    }
    return result;
  };
  ASSERT_EQ(values("across_mm").size(), 2u) << run.out;
  for (int half = 0; half < 2; ++half) {
    EXPECT_GT(values("held_out")[half], 700);
    // Angles are good to half a millimetre; distances have sigmas of their own.
    EXPECT_LT(values("across_mm")[half], 0.7);
    EXPECT_LT(values("along_sigmas")[half], 1.5);
    EXPECT_GT(values("along_sigmas")[half], 0.7);
    for (const std::string kind : {"factors", "positions"}) {
      const double ratio =
          values(kind + "_chi2")[half] / values(kind + "_freedom")[half];
      EXPECT_GT(ratio, 0.7) << kind;
      EXPECT_LT(ratio, 1.5) << kind;
    }
    // Between the two clocks; the same in both halves, from nothing.
    EXPECT_NEAR(values("delay_ms")[half], -143.5, 2.0);
  }
  // Where both halves meet; 99 % of chi^2 with 6 degrees of freedom.
  ASSERT_EQ(values("bias_distance").size(), 1u);
  EXPECT_LT(values("bias_distance")[0], 16.8);
}

}  // namespace
}  // namespace rgbd_pose
