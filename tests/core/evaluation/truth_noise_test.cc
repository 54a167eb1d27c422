#include "core/evaluation/truth_noise.h"

#include <gtest/gtest.h>

#include "core/util/units.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

class TruthNoiseTest : public ::testing::Test {
 protected:
  TruthNoise Read(const std::string& text) {
    return ReadTruthNoise(folder_.Write("groundtruth.txt", text));
  }

  TempFolder folder_;
};

TEST_F(TruthNoiseTest, IsReadFromTheHeadOfTheFile) {
  const TruthNoise noise =
      Read("# ground truth\n# truth_sigma: 0.004 m 0.5 deg\n1 0 0 0 0 0 0 1\n");
  EXPECT_DOUBLE_EQ(noise.translation, 0.004);
  EXPECT_DOUBLE_EQ(noise.rotation, 0.5 * kRadiansPerDegree);
  EXPECT_EQ(noise.InWords(), "sigma 4 mm, 0.5 deg, as its file says");
}

TEST_F(TruthNoiseTest, OfATumRecordingIsKnown) {
  const TruthNoise noise = Read(
      "# ground truth trajectory\n"
      "# file: 'rgbd_dataset_freiburg1_xyz.bag'\n1 0 0 0 0 0 0 1\n");
  EXPECT_DOUBLE_EQ(noise.translation, 0.002);
  EXPECT_DOUBLE_EQ(noise.rotation, 0.2 * kRadiansPerDegree);
  // What the file says of itself is preferred.
  EXPECT_EQ(Read("# file: 'rgbd_dataset_freiburg1_xyz.bag'\n"
                 "# truth_sigma: 0 m 0 deg\n")
                .InWords(),
            "exact, as its file says");
}

TEST_F(TruthNoiseTest, IsElseUnknown) {
  for (const char* text :
       {"", "1 0 0 0 0 0 0 1\n", "# file: 'kitchen.bag'\n1 0 0 0 0 0 0 1\n",
        "1 0 0 0 0 0 0 1\n# truth_sigma: 0.002 m 0.2 deg\n"}) {
    EXPECT_EQ(Read(text).InWords(), "assumed exact") << text;
  }
}

TEST_F(TruthNoiseTest, IsWrittenAndReadBack) {
  const Trajectory path = {{1.0, Rigid3d()}};
  const TruthNoise noise = {0.002, 0.003, "as known"};
  const TruthNoise again = Read(FormatTruth(path, noise));
  EXPECT_NEAR(again.translation, noise.translation, 1e-9);
  EXPECT_NEAR(again.rotation, noise.rotation, 1e-8);
  EXPECT_EQ(FormatTruth(path, {}), FormatTrajectory(path));
}

TEST_F(TruthNoiseTest, RefusesABadLine) {
  for (const char* line : {"0.002", "0.002 mm 0.2 deg", "0.002 m 0.2 rad",
                           "x m 0.2 deg", "-1 m 0.2 deg", "0.002 m nan deg"}) {
    ExpectInputError(
        [&] { Read("# truth\n# truth_sigma: " + std::string(line) + "\n"); },
        {"groundtruth.txt:2"});
  }
}

}  // namespace
}  // namespace rgbd_pose
