#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "costs/cost_factory.h"
#include "costs/direct_cost_factory.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/tracking/odometry.h"
#include "frontend/tracking/tracker_factory.h"
#include "tests/support/shutter_sequence.h"
#include "tests/support/tracker_parts.h"

namespace rgbd_pose {
namespace {

TEST(HybridTrackerTest, PixelsAloneWaitWhileAGuessIsTentative) {
  SyntheticOptions options;
  options.scene = "plain_room";
  options.path = "pan_tilt";
  options.frames = 40;
  const SyntheticDataset room(options);
  const PreparedFrame before(room.Read(10)), wall(room.Read(11));
  const auto tracker = MakeTracker("hybrid", PartsFor(room.camera().camera));
  const auto reference = ReferenceOf(tracker.get(), before);
  TrackingResult tracked(room.camera().camera);
  TrackingGuess guess = Rigid3d();
  tracker->Track(*reference, wall, guess, &tracked);
  EXPECT_EQ(tracked.source, TrackingSource::kDirect);
  EXPECT_FALSE(tracked.is_partial);
  guess.is_tentative = true;
  tracker->Track(*reference, wall, guess, &tracked);
  EXPECT_NE(tracked.source, TrackingSource::kDirect);
  EXPECT_TRUE(tracked.is_partial);
}

TEST(HybridTrackerTest, ARefinementThatIsLeftCanBeMadeLater) {
  const SyntheticDataset room((SyntheticOptions()));
  const PreparedFrame before(room.Read(0)), next(room.Read(1));
  const auto tracker = MakeTracker("hybrid", PartsFor(room.camera().camera));
  const auto reference = ReferenceOf(tracker.get(), before);
  TrackingResult at_once(room.camera().camera), later = at_once;
  TrackingGuess guess = Rigid3d();
  tracker->Track(*reference, next, guess, &at_once);
  EXPECT_EQ(at_once.source, TrackingSource::kBoth);
  EXPECT_FALSE(at_once.needs_refinement);
  guess.leaves_refinement = true;
  tracker->Track(*reference, next, guess, &later);
  EXPECT_EQ(later.source, TrackingSource::kFeatures);
  EXPECT_TRUE(later.needs_refinement);
  EXPECT_NE(later.estimate.covariance, at_once.estimate.covariance);
  tracker->Refine(*reference, next, guess, &later);
  EXPECT_EQ(later.source, TrackingSource::kBoth);
  EXPECT_FALSE(later.needs_refinement);
  EXPECT_EQ(later.estimate.covariance, at_once.estimate.covariance);
  EXPECT_EQ(later.estimate.iterations, at_once.estimate.iterations);
}

// Returns the motion between two frames, refined by pixels under `cost`.
Rigid3d RefinedMotion(const std::string& cost, const Camera& camera,
                      const Frame& before, const Frame& after,
                      const TrackingGuess& guess) {
  TrackerParts parts = PartsFor(camera);
  parts.direct_estimators->refining = Estimator(
      DirectEstimatorOptions(),
      JoinCosts(MakeRobustCosts(), MakeDirectCosts(cost, kDefaultDirectLoss)));
  const auto tracker = MakeTracker("hybrid", std::move(parts));
  const auto reference = ReferenceOf(tracker.get(), PreparedFrame(before));
  TrackingResult tracked(camera);
  tracker->Track(*reference, PreparedFrame(after), guess, &tracked);
  EXPECT_EQ(tracked.source, TrackingSource::kBoth);
  return tracked.estimate.cur_from_prev;
}

TEST(HybridTrackerTest, DepthOfAnotherMomentIsNotAligned) {
  const auto refine = [](const std::string& cost, const Shutters& shutters,
                         bool aligns_depth) {
    const SyntheticDataset room(ShutterOptions("handheld", shutters));
    TrackingGuess guess =
        room.WorldFromCam(34).Inverse() * room.WorldFromCam(30);
    guess.aligns_depth = aligns_depth;
    return RefinedMotion(cost, room.camera().camera, room.Read(30),
                         room.Read(34), guess)
        .translation;
  };
  const Shutters rolling = RollingShutters(1.0);
  const Eigen::Vector3d by_gray = refine("photometric", rolling, true);
  EXPECT_EQ(refine(kDefaultDirectCost, rolling, false), by_gray);
  EXPECT_NE(refine(kDefaultDirectCost, rolling, true), by_gray);
  // Unless neighbouring features err alike, depth is aligned.
  EXPECT_EQ(refine(kDefaultDirectCost, {}, false),
            refine(kDefaultDirectCost, {}, true));
}

// Returns the last pose of a camera with rolling shutters.
Rigid3d LastPose(const ShutterSequence& sequence, ShutterUse use,
                 double max_time_shift) {
  OdometryOptions options;
  options.shutter = use;
  options.max_time_shift = max_time_shift;
  Odometry odometry(
      options,
      MakeTracker("hybrid", PartsFor(sequence.dataset.camera().camera)));
  for (const Frame& frame : sequence.frames) odometry.Track(frame);
  return odometry.WorldFromCam();
}

TEST(HybridTrackerTest, DepthIsAlignedIfTimesAreKnown) {
  constexpr double kNoLimit = 1.0;     // m
  constexpr double kDefault = 3.5e-3;  // m
  const ShutterSequence fast("handheld", RollingShutters(1.0));
  const auto position = [&](ShutterUse use, double max_time_shift) {
    return LastPose(fast, use, max_time_shift).translation;
  };
  EXPECT_EQ(position(ShutterUse::kCamera, kDefault),
            position(ShutterUse::kCamera, kNoLimit));
  EXPECT_NE(position(ShutterUse::kNone, kDefault),
            position(ShutterUse::kNone, kNoLimit));
}

}  // namespace
}  // namespace rgbd_pose
