// A moving object in the view must not affect the motion, or the frame must not
// be reported as ok.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "frontend/tracking/odometry.h"
#include "tests/support/rendered_once.h"
#include "tests/support/tracker_parts.h"

namespace rgbd_pose {
namespace {

struct PatchRun {
  int ok = 0;
  int wrong = 0;        // of the ok frames
  double median = 0.0;  // error of the motion since the reference, m
};

// A poster moves through a share of the view by 5 to 8 px per frame.
SyntheticOptions WithPatch(double share) {
  SyntheticOptions options;
  options.frames = 240;
  options.moving_patch = share;
  return options;
}

PatchRun TrackWithPatch(const std::string& tracker, const RenderedOnce& room,
                        int frames, double max_error) {
  Odometry odometry({}, MakeTracker(tracker, PartsFor(room.camera().camera)));
  std::vector<double> errors;
  PatchRun outcome;
  for (int i = 0; i < frames; ++i) {
    const TrackedFrame tracked = odometry.Track(room.Read(i));
    if (i == 0 || tracked.status != TrackingStatus::kOk) continue;
    ++outcome.ok;
    const RelativePose& edge = tracked.edges.at(0);
    const Rigid3d truth =
        room.WorldFromCam(edge.cur).Inverse() * room.WorldFromCam(edge.ref);
    errors.push_back((edge.cur_from_ref * truth.Inverse()).translation.norm());
    outcome.wrong += errors.back() > max_error;
  }
  std::sort(errors.begin(), errors.end());
  outcome.median = errors.empty() ? 0.0 : errors[errors.size() / 2];
  return outcome;
}

TEST(MovingThingsTest, PixelsDoNotOverruleFeatures) {
  constexpr int kFrames = 25;
  for (const double share : {0.1, 0.2}) {
    const RenderedOnce room(WithPatch(share));
    const PatchRun features = TrackWithPatch("features", room, kFrames, 1e-3);
    const PatchRun both = TrackWithPatch("hybrid", room, kFrames, 1e-3);
    EXPECT_EQ(features.ok, kFrames - 1);
    EXPECT_EQ(both.ok, kFrames - 1);
    EXPECT_EQ(both.wrong, 0) << share;
    EXPECT_LE(both.median, 1.1 * features.median) << share;
  }
}

// Before the poster has moved apart from the room, one motion fits both
// halfway.
TEST(MovingThingsTest, ACompromiseIsNotOk) {
  const RenderedOnce room(WithPatch(0.4));
  const PatchRun run = TrackWithPatch("hybrid", room, 4, 1e-2);
  EXPECT_EQ(run.wrong, 0);
  // Later, when only the room is followed, frames are ok again.
  EXPECT_GE(TrackWithPatch("hybrid", room, 12, 1e-2).ok, 6);
}

}  // namespace
}  // namespace rgbd_pose
