// What docs/examples/wheel_scale.cc prints: the scale of wheel odometry.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/run_program.h"

namespace rgbd_pose {
namespace {

TEST(WheelScaleTest, FindsTheScaleToItsSigma) {
  const RunResult run = RunCommand(RGBD_POSE_WHEEL_SCALE, TempFolder());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  double scale = 0.0, sigma = 0.0, truth = 0.0;
  ASSERT_EQ(std::sscanf(run.out.c_str(),
                        "the scale is %lf, sigma %lf; in truth it is %lf\n",
                        &scale, &sigma, &truth),
            3)
      << run.out;
  EXPECT_EQ(truth, 1.04);
  EXPECT_LT(std::abs(scale - truth), 3.0 * sigma);
  // By 2 mm in each of five steps, which are about 0.2 m long.
  EXPECT_NEAR(sigma, 0.002 / (0.2 * std::sqrt(5.0)), 0.001);
}

}  // namespace
}  // namespace rgbd_pose
