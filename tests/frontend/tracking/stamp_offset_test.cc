#include "frontend/tracking/stamp_offset.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <typeinfo>

#include "core/util/input_error.h"
#include "frontend/features/frontend.h"
#include "frontend/simulation/synthetic_dataset.h"

namespace rgbd_pose {
namespace {

Frame FrameWithDelay(double delay) {
  Frame frame = SyntheticDataset({"room", "handheld", 1}).Read(0);
  frame.depth_delay = delay;
  return frame;
}

const RecentMotion kTurning(Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(
                                        0.03, Eigen::Vector3d::UnitY())),
                                    {0.02, 0.0, 0.0}),
                            1.0 / 30.0);

TEST(StampOffsetTest, MotionsAreInProportionToTime) {
  constexpr double kTolerance = 1e-12;  // rounding
  const Rigid3d half = kTurning.During(1.0 / 60.0);
  EXPECT_NEAR(half.Angle(), 0.015, kTolerance);
  EXPECT_NEAR(half.translation.x(), 0.01, kTolerance);
  EXPECT_NEAR((half * kTurning.During(-1.0 / 60.0)).Angle(), 0.0, kTolerance);
}

TEST(StampOffsetTest, LeavesFramesAloneWhereThereIsNothingToDo) {
  StampOffset offset((Camera()));
  const PreparedFrame late(FrameWithDelay(0.015));
  EXPECT_NE(offset.Undo(late, kTurning), nullptr);
  EXPECT_EQ(offset.Undo(late, RecentMotion()), nullptr);
  const Rigid3d leap(Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0});
  EXPECT_EQ(offset.Undo(late, RecentMotion(leap, 1.0 / 30.0)), nullptr);
  for (const double delay :
       {0.0, 5e-5, -5e-5, 3.0, -0.1, std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(offset.Undo(PreparedFrame(FrameWithDelay(delay)), kTurning),
              nullptr)
        << delay;
  }
}

// Depth of 15 ms later, brought back, is not the same as of 15 ms earlier.
TEST(StampOffsetTest, GoesTheWayThatTheSignSays) {
  StampOffset offset((Camera()));
  const PreparedFrame late(FrameWithDelay(0.015));
  DepthMover mover((Camera()));
  const auto undone = offset.Undo(late, kTurning);
  EXPECT_EQ(undone->depth_delay, 0.0);
  EXPECT_EQ(cv::norm(undone->depth, mover.Move(late, kTurning.During(-0.015)),
                     cv::NORM_INF),
            0.0);
  EXPECT_GT(cv::norm(undone->depth, late.depth, cv::NORM_INF), 100.0);
}

TEST(StampOffsetTest, EveryFrontendsPreparedFrameCopiesItself) {
  const Frame frame = FrameWithDelay(-0.01);
  StampOffset offset((Camera()));
  for (const std::string& name : FrontendNames()) {
    const auto frontend = MakeFrontend(name, FrontendOptions());
    const auto prepared = frontend->Prepare(frame);
    const auto undone = offset.Undo(*prepared, kTurning);
    ASSERT_NE(undone, nullptr) << name;
    const PreparedFrame &copy = *undone, &original = *prepared;
    EXPECT_TRUE(typeid(copy) == typeid(original)) << name;
    EXPECT_GT(frontend->Detect(*undone)->observations.size(), 100u) << name;
  }
}

TEST(StampOffsetTest, RefusesAPreparedFrameThatDoesNot) {
  struct Forgetful : PreparedFrame {
    using PreparedFrame::PreparedFrame;
  };
  StampOffset offset((Camera()));
  EXPECT_THROW(offset.Undo(Forgetful(FrameWithDelay(0.01)), kTurning),
               InputError);
}

}  // namespace
}  // namespace rgbd_pose
