// What carries the camera stands still in the image: it is left out once that
// is known, and nothing else is.

#include "frontend/tracking/carried_region.h"

#include <gtest/gtest.h>

#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/tracking/odometry.h"
#include "tests/support/tracker_parts.h"

namespace rgbd_pose {
namespace {

constexpr double kShare = 0.4;

SyntheticDataset Room(double carrier, int frames) {
  SyntheticOptions options;
  options.path = "handheld";
  options.frames = frames;
  options.carrier = carrier;
  return SyntheticDataset(options);
}

// Learns the true motions from the first frame to later ones.
CarriedRegion Learnt(const SyntheticDataset& room, int frames) {
  CarriedRegion region;
  const Frame ref = room.Read(0);
  for (int i = 2; i < frames; ++i) {
    region.Learn(ref, room.Read(i), room.camera().camera,
                 room.WorldFromCam(i).Inverse() * room.WorldFromCam(0));
  }
  return region;
}

// Share of the rows from `top` to `bottom` without depth.
double ShareWithoutDepth(const cv::Mat& depth, int top, int bottom) {
  const cv::Mat part = depth.rowRange(top, bottom);
  return 1.0 - static_cast<double>(cv::countNonZero(part)) / part.total();
}

TEST(CarriedRegionTest, LeavesOutWhatStandsStill) {
  constexpr int kFrames = 10;
  const SyntheticDataset room = Room(kShare, kFrames);
  const CarriedRegion region = Learnt(room, kFrames);
  ASSERT_FALSE(region.empty());
  const cv::Mat depth = room.Read(0).depth;
  const cv::Mat left = region.WithoutRegion(depth);
  const int edge = static_cast<int>((1.0 - kShare) * depth.rows);
  EXPECT_GT(ShareWithoutDepth(left, edge, depth.rows), 0.6);
  EXPECT_NEAR(ShareWithoutDepth(left, 0, edge - 40),
              ShareWithoutDepth(depth, 0, edge - 40), 0.01);
  // The measured image stays as it was.
  EXPECT_LT(ShareWithoutDepth(depth, edge, depth.rows), 0.1);
}

TEST(CarriedRegionTest, LeavesTheSceneAlone) {
  constexpr int kFrames = 20;
  EXPECT_TRUE(Learnt(Room(0.0, kFrames), kFrames).empty());
}

// With 40 % of the view on what carries the camera, a third of the path was
// missing before.
TEST(CarriedRegionTest, TheCarrierDoesNotHoldTheCamera) {
  constexpr int kFrames = 60;
  constexpr double kMaxError = 0.005;  // m
  const SyntheticDataset room = Room(kShare, 150);
  Odometry odometry({}, MakeTracker("hybrid", PartsFor(room.camera().camera)));
  TrackedFrame tracked;
  for (int i = 0; i < kFrames; ++i) tracked = odometry.Track(room.Read(i));
  const Rigid3d truth =
      room.WorldFromCam(0).Inverse() * room.WorldFromCam(kFrames - 1);
  ASSERT_GT(truth.translation.norm(), 0.1);
  EXPECT_LT((tracked.world_from_cam.translation - truth.translation).norm(),
            kMaxError);
}

}  // namespace
}  // namespace rgbd_pose
