// What several passes over a recording say together: no camera is accepted that
// the halves of the recording do not confirm.

#include "frontend/calibration/calibration_passes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/calibration/calibration_verdict.h"

namespace rgbd_pose {
namespace {

using Status = CalibratedParameter::Status;
using testing::HasSubstr;

constexpr double kAgree = 1.0, kDisagree = 7.8;  // sigmas

// A pass that finds a delay of depth and displaces depth by pixels. The halves
// differ by this many sigmas; 0: they have too little data.
CalibrationResult FoundDelay(double seconds, double halves_sigmas) {
  CalibrationResult result;
  result.found.depth_shutter.offset = seconds;
  CalibratedParameter& delay = result.parameters[kDepthTime];
  delay.status = Status::kDetermined;
  delay.found = seconds;
  delay.sigma = 1e-4;
  delay.prior = 0.02;
  result.displacement_px = 4.5;
  result.is_better = true;
  if (halves_sigmas > 0.0) {
    result.halves = {{kDepthTime, 0.0, halves_sigmas, 1.0}};
  }
  result.Conclude({}, WhyUnchecked({}, result));
  return result;
}

// A pass that keeps its camera.
CalibrationResult FoundNothing(double halves_sigmas) {
  CalibrationResult result = FoundDelay(0.0, halves_sigmas);
  result.is_better = false;
  result.displacement_px = 0.0;
  result.Conclude({}, "the ground truth contradicts it");
  return result;
}

TEST(CalibrationPassesTest, AFirstStepIsNotAcceptedUnchecked) {
  const CalibrationResult only = FoundDelay(-0.017, kDisagree);
  EXPECT_TRUE(IsAnotherPassDue(only));
  EXPECT_FALSE(only.is_accepted);
  EXPECT_THAT(only.reason, HasSubstr("another pass is needed"));
  EXPECT_EQ(only.camera.depth_shutter.offset, 0.0);
  EXPECT_FALSE(FoundDelay(-0.017, 0.0).is_accepted);
}

TEST(CalibrationPassesTest, AStepWhoseSuccessorIsDroppedIsChecked) {
  CalibrationResult all = FoundDelay(-0.017, kDisagree);
  for (const double halves : {0.0, kDisagree}) {
    TakeUp({}, {}, FoundNothing(halves), &all);
    EXPECT_FALSE(all.is_accepted) << halves;
    EXPECT_THAT(all.reason, HasSubstr("the halves of the recording"));
    EXPECT_EQ(all.camera.depth_shutter.offset, 0.0);
  }
  // Mapped with the camera found, the halves agree.
  TakeUp({}, {}, FoundNothing(kAgree), &all);
  EXPECT_TRUE(all.is_accepted) << all.reason;
  EXPECT_EQ(all.camera.depth_shutter.offset, -0.017);
  EXPECT_EQ(all.passes, 4);
}

TEST(CalibrationPassesTest, AFurtherStepIsTakenUpAndChecked) {
  CalibrationResult all = FoundDelay(-0.017, kDisagree);
  CalibrationResult further = FoundDelay(-0.018, kAgree);
  further.displacement_px = 0.1;
  EXPECT_FALSE(IsAnotherPassDue(further));
  TakeUp({}, {}, further, &all);
  EXPECT_TRUE(all.is_accepted) << all.reason;
  EXPECT_EQ(all.camera.depth_shutter.offset, -0.018);
  EXPECT_EQ(all.parameters[kDepthTime].found, -0.018);

  TakeUp({}, {}, FoundDelay(-0.019, kDisagree), &all);
  EXPECT_FALSE(all.is_accepted);
  EXPECT_THAT(all.reason, HasSubstr("disagree: depth_time_offset differs"));
}

TEST(CalibrationPassesTest, AnImplausibleStepIsDropped) {
  CalibrationResult all = FoundDelay(-0.017, kAgree);
  TakeUp({}, {}, FoundDelay(-0.1, kAgree), &all);  // five sigmas of the prior
  EXPECT_TRUE(all.is_accepted) << all.reason;
  EXPECT_EQ(all.camera.depth_shutter.offset, -0.017);
}

TEST(CalibrationPassesTest, TheLastHalvesWidenAllErrorBars) {
  CalibrationResult all = FoundDelay(-0.017, kAgree);
  CalibrationResult further = FoundNothing(kAgree);
  further.halves_spread = 2.0;
  TakeUp({}, {}, further, &all);
  EXPECT_DOUBLE_EQ(all.parameters[kDepthTime].sigma, 2e-4);
}

}  // namespace
}  // namespace rgbd_pose
