#include "apps/results/run_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace rgbd_pose {
namespace {

constexpr int kFrames = 120;

// A handheld camera that swings by 0.3 m within a second, at up to 10 m/s^2.
std::vector<TrackedFrame> Swing() {
  std::vector<TrackedFrame> frames(kFrames);
  for (int i = 0; i < kFrames; ++i) {
    frames[i].timestamp = i / 30.0;
    frames[i].status = TrackingStatus::kOk;
    frames[i].world_from_cam.translation.x() = 0.3 * std::sin(i / 30.0 * 6.0);
  }
  return frames;
}

TEST(MotionJumpsTest, AShakenCameraDoesNotJump) {
  EXPECT_TRUE(FindJumps(Swing()).empty());
  EXPECT_TRUE(FindJumps({}).empty());
}

TEST(MotionJumpsTest, AllPosesFromOneFrameOnAreElsewhere) {
  std::vector<TrackedFrame> frames = Swing();
  for (int i = 50; i < kFrames; ++i) {
    frames[i].world_from_cam.translation.y() += 0.03;
  }
  frames[50].matches = 200;
  frames[50].inliers = 18;
  frames[50].source = TrackingSource::kFeatures;
  const nlohmann::json jumps = FindJumps(frames);
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_EQ(jumps[0].at("frame"), 50);
  // Plus a part of the swing.
  EXPECT_NEAR(jumps[0].at("translation_m"), 0.03, 1e-3);
  EXPECT_THAT(FormatJumps(jumps),
              testing::HasSubstr("frame 50 by 30 mm (18 of 200 matches agree); "
                                 "--debug_images=50"));
  EXPECT_EQ(jumps[0].at("inliers"), 18);
}

TEST(MotionJumpsTest, OnePoseThatIsOffIsOneJump) {
  std::vector<TrackedFrame> frames = Swing();
  frames[50].world_from_cam.translation.y() += 0.03;
  EXPECT_EQ(FindJumps(frames).size(), 1u);
}

TEST(MotionJumpsTest, WhereFramesAreMissingMotionsAreNotCompared) {
  std::vector<TrackedFrame> frames = Swing();
  for (int i = 50; i < kFrames; ++i) {
    frames[i].timestamp += 0.2;
    frames[i].world_from_cam.translation.y() += 0.5;
  }
  EXPECT_TRUE(FindJumps(frames).empty());
  frames = Swing();
  frames[50].status = TrackingStatus::kLost;
  for (int i = 51; i < kFrames; ++i) {
    frames[i].world_from_cam.translation.y() += 0.5;
  }
  EXPECT_TRUE(FindJumps(frames).empty());
}

}  // namespace
}  // namespace rgbd_pose
