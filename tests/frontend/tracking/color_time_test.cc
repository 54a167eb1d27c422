#include "frontend/tracking/color_time.h"

#include <gtest/gtest.h>

#include "core/evaluation/evaluation.h"
#include "tests/support/track_sequence.h"

namespace rgbd_pose {
namespace {

// Depth of 15 ms earlier or later is at the wrong place by up to 10 px here.
TEST(ColorTimeTest, UndoesTheOffsetOfTheDepthStamps) {
  const auto position_error = [](double delay, bool ignore) {
    SyntheticOptions options;
    options.path = "handheld";
    options.frames = 40;
    options.camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5};
    options.depth_delay_s = delay;
    const SyntheticDataset dataset(options);
    OdometryOptions odometry_options;
    odometry_options.ignore_stamp_offset = ignore;
    const TrackedSequence run = TrackAll(dataset, "tukey", odometry_options);
    EXPECT_EQ(run.Count(TrackingStatus::kOk), dataset.size());
    return Evaluate(run.trajectory, dataset.ground_truth(), {}).ate.rmse;
  };
  const double without = position_error(0.0, false);
  EXPECT_EQ(position_error(0.0, true), without);
  for (const double delay : {0.015, -0.015}) {
    const double undone = position_error(delay, false);
    // The rest is acceleration.
    EXPECT_LT(undone, 2.0 * without) << delay;
    EXPECT_GT(position_error(delay, true), 5.0 * undone) << delay;
  }
}

// The first two depths are 63 ms apart, their colours 33 ms: without halving
// what comes of it, the first motion swings around the true one.
TEST(ColorTimeTest, UndoesOffsetsThatAlternate) {
  const auto first_error = [](bool ignore) {
    SyntheticOptions options;
    options.path = "xyz";
    options.noise = false;
    options.depth_delay_s = -0.015;
    const SyntheticDataset early(options);
    options.depth_delay_s = 0.015;
    const SyntheticDataset late(options);
    OdometryOptions odometry_options;
    odometry_options.ignore_stamp_offset = ignore;
    Odometry odometry =
        MakeOdometry(late.camera().camera, "tukey", odometry_options);
    odometry.Track(early.Read(112));
    const Rigid3d truth =
        early.WorldFromCam(112).Inverse() * early.WorldFromCam(113);
    const Rigid3d found = odometry.Track(late.Read(113)).world_from_cam;
    return (found.translation - truth.translation).norm();
  };
  EXPECT_LT(first_error(false), 0.1 * first_error(true));
}

}  // namespace
}  // namespace rgbd_pose
