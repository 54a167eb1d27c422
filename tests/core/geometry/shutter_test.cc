#include <gtest/gtest.h>

#include <set>
#include <string>

#include "core/geometry/camera.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {
namespace {

constexpr double kShutterRounding = 1e-15;  // s

TEST(ShutterTest, AllRowsOfAGlobalOneAreAtTheStamp) {
  const Shutter shutter;
  EXPECT_TRUE(shutter.IsGlobal());
  for (const double row : {0.0, 239.5, 479.0}) {
    EXPECT_EQ(shutter.RowTime(row, 480), 0.0);
  }
  EXPECT_FALSE((Shutter{0.01, 0.0}).IsGlobal());
  EXPECT_FALSE((Shutter{0.0, -0.01}).IsGlobal());
}

// The upper and lower edge of the image are one readout apart. They are half a
// row outside the centres of the first and last row.
TEST(ShutterTest, RowsFollowOneAnother) {
  const Shutter shutter = {-0.004, 0.024};
  EXPECT_NEAR(shutter.RowTime(-0.5, 480), -0.016, kShutterRounding);
  EXPECT_NEAR(shutter.RowTime(239.5, 480), -0.004, kShutterRounding);
  EXPECT_NEAR(shutter.RowTime(479.5, 480), 0.008, kShutterRounding);
  EXPECT_NEAR(shutter.RowTime(101.0, 480) - shutter.RowTime(100.0, 480),
              0.024 / 480, kShutterRounding);
}

TEST(ShutterTest, ANegativeReadoutMirrorsTheImage) {
  const Shutter down = {0.003, 0.02};
  const Shutter up = {0.003, -0.02};
  for (const double row : {0.0, 17.25, 119.0}) {
    EXPECT_NEAR(up.RowTime(row, 120), down.RowTime(119.0 - row, 120),
                kShutterRounding);
  }
}

TEST(ShutterTest, ParametersAreAllNumbersOfBothShutters) {
  RgbdCamera camera;
  std::set<std::string> names;
  double value = 0.0;
  for (const ShutterParameter& parameter : kShutterParameters) {
    names.insert(parameter.name);
    camera.*parameter.image.*parameter.value = value += 1.0;
  }
  EXPECT_EQ(names.size(), 4u);
  EXPECT_EQ(camera.color_shutter.offset, 1.0);
  EXPECT_EQ(camera.color_shutter.readout, 2.0);
  EXPECT_EQ(camera.depth_shutter.offset, 3.0);
  EXPECT_EQ(camera.depth_shutter.readout, 4.0);
}

}  // namespace
}  // namespace rgbd_pose
