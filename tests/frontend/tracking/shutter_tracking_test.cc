// Tracking of cameras with rolling shutters.

#include "frontend/tracking/shutter_tracking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/evaluation/evaluation.h"
#include "tests/support/motion_error.h"
#include "tests/support/shutter_sequence.h"

namespace rgbd_pose {
namespace {

// RMSE of positions at the time stamps, m.
double PositionError(const ShutterSequence& sequence,
                     const std::string& tracker,
                     ShutterUse use = ShutterUse::kCamera) {
  Odometry odometry = OdometryFor(sequence, tracker, use);
  Trajectory path;
  for (const Frame& frame : sequence.frames) {
    const TrackedFrame tracked = odometry.Track(frame);
    path.push_back({tracked.timestamp, tracked.world_from_cam});
  }
  return Evaluate(path, sequence.dataset.ground_truth(), {}).ate.rmse;
}

// Largest error allowed relative to global shutters, and smallest error if
// shutters are ignored. Pixel costs know velocities only from motions, half a
// frame late.
struct ShutterTrust {
  const char* tracker;
  double at_most, ignored_at_least;
};

class ShutterTrackersTest : public testing::TestWithParam<ShutterTrust> {
 protected:
  // All trackers share the sequences.
  void ExpectUndone(const ShutterSequence& sequence) {
    const auto& [tracker, at_most, ignored_at_least] = GetParam();
    static const ShutterSequence without("handheld", {});
    static std::map<std::string, double> global;  // by tracker
    if (global.count(tracker) == 0) {
      global[tracker] = PositionError(without, tracker);
    }
    const double undone = PositionError(sequence, tracker);
    EXPECT_LT(undone, at_most * global[tracker]);
    EXPECT_GT(PositionError(sequence, tracker, ShutterUse::kNone),
              ignored_at_least * undone);
  }
};

TEST_P(ShutterTrackersTest, FromTheTop) {
  static const ShutterSequence sequence("handheld", RollingShutters(1.0));
  ExpectUndone(sequence);
}
TEST_P(ShutterTrackersTest, FromTheBottom) {
  static const ShutterSequence sequence("handheld", RollingShutters(-1.0));
  ExpectUndone(sequence);
}

// Depth 15 ms earlier or later is displaced by up to 10 px here.
TEST_P(ShutterTrackersTest, LaterDepth) {
  static const ShutterSequence sequence("handheld", {{}, {}, 0.015});
  ExpectUndone(sequence);
}
TEST_P(ShutterTrackersTest, EarlierDepth) {
  static const ShutterSequence sequence("handheld", {{}, {}, -0.015});
  ExpectUndone(sequence);
}

INSTANTIATE_TEST_SUITE_P(All, ShutterTrackersTest,
                         testing::Values(ShutterTrust{"features", 2.5, 5.0},
                                         ShutterTrust{"direct", 12.0, 1.4},
                                         ShutterTrust{"hybrid", 4.2, 5.0}),
                         [](const auto& info) {
                           return std::string(info.param.tracker);
                         });

// A frame becomes a reference at once, as it was measured. The next frame is
// tracked against it and makes its velocity accurate.
TEST(ShutterTrackingTest, GoesOnFromANewReference) {
  const ShutterSequence sequence("pan_tilt", RollingShutters(1.0), 60);
  Odometry odometry = OdometryFor(sequence, "features", ShutterUse::kCamera);
  // A reference is not moved by less than 0.2 px, 0.024 rad/s of this camera.
  // The first two frames have the same rows and the same prior, so the velocity
  // of each is less certain.
  constexpr double kMaxAngular = 0.024 + 0.003;         // rad/s
  constexpr double kMaxAngularOfFirst = 0.024 + 0.008;  // rad/s
  int new_references = 0;
  bool is_new = false;
  for (int i = 0; i < static_cast<int>(sequence.frames.size()); ++i) {
    const TrackedFrame tracked = odometry.Track(sequence.frames[i]);
    ASSERT_EQ(tracked.status, TrackingStatus::kOk);
    if (is_new) {
      ++new_references;
      ASSERT_EQ(tracked.reference, i - 1);
      EXPECT_EQ(tracked.edges.front().ref, i - 1);
      EXPECT_LT(ErrorOf(tracked.cur_from_reference, sequence.Motion(i - 1, i))
                    .translation,
                0.004);
      const Keyframe& keyframe = *odometry.FindKeyframe(i - 1);
      EXPECT_EQ(cv::norm(keyframe.frame.gray, sequence.frames[i - 1].gray,
                         cv::NORM_INF),
                0.0);
      ASSERT_TRUE(keyframe.frame.twist.has_value());
      const int before = std::max(i - 2, 0);
      const Twist around =
          TwistOf(sequence.Motion(before, i), (i - before) / 30.0);
      EXPECT_LT((keyframe.frame.twist->angular - around.angular).norm(),
                before == i - 1 ? kMaxAngularOfFirst : kMaxAngular);
    }
    is_new = tracked.is_reference;
  }
  EXPECT_GE(new_references, 3);
}

// A frame that is tracked against the last one, whose pose is certain, must be
// where a certain guess says: also if the last frame has just become a
// reference, or its images were mended.
TEST(ShutterTrackingTest, ACertainGuessDecidesWhatFollowsTheLastFrame) {
  const ShutterSequence sequence("handheld", RollingShutters(1.0), 30);
  TrackerParts parts = PartsFor(sequence.dataset.camera().camera);
  parts.estimator = Estimator(
      {}, MakeRobustCosts("bidirectional_point+motion_prior", "tukey,none"));
  Odometry odometry({}, MakeTracker("features", std::move(parts)));
  const MotionMatrix covariance = 1e-12 * MotionMatrix::Identity();
  Rigid3d last;
  int from_last = 0;
  for (int i = 0; i < 30; ++i) {
    const Rigid3d guess = sequence.Motion(std::max(i - 1, 0), i);
    const TrackedFrame tracked =
        odometry.Track(sequence.frames[i], i > 0 ? &guess : nullptr,
                       i > 0 ? &covariance : nullptr);
    const Rigid3d error = guess * last.Inverse() * tracked.world_from_cam;
    last = tracked.world_from_cam;
    if (i == 0 || tracked.edges.front().ref != i - 1) continue;
    EXPECT_LT(error.translation.norm() + error.Angle(), 1e-5) << i;
    ++from_last;
  }
  EXPECT_GE(from_last, 2);
}

// The velocity changes so fast that where depth was exposed is predicted badly.
TEST(ShutterTrackingTest, LaterDepthInAFastPan) {
  constexpr int kCount = 40;  // up to 200 degrees/s
  SyntheticOptions options = ShutterOptions("pan_tilt", {{}, {}, 0.015});
  options.frames = kCount;
  const SyntheticDataset dataset(options);
  Odometry odometry({},
                    MakeTracker("hybrid", PartsFor(dataset.camera().camera)));
  Trajectory path;
  for (int i = 0; i < kCount; ++i) {
    const TrackedFrame tracked = odometry.Track(dataset.Read(i));
    EXPECT_EQ(tracked.status, TrackingStatus::kOk) << i << tracked.reason;
    path.push_back({tracked.timestamp, tracked.world_from_cam});
  }
  EXPECT_LT(Evaluate(path, dataset.ground_truth(), {}).ate.rmse, 0.003);
}

// Rotation (up to 38 degrees/s, almost in place) and translation along the
// axes. In one of two directions, translation hides most of the shutter's
// effect.
TEST(ShutterTrackingTest, OfPureMotions) {
  constexpr int kCount = 24;
  for (const std::string path : {"pan_tilt", "xyz"}) {
    const double global =
        PositionError(ShutterSequence(path, {}, kCount), "features");
    double undone = 0.0, ignored = 0.0;
    for (const double sign : {1.0, -1.0}) {
      const ShutterSequence rolling(path, RollingShutters(sign), kCount);
      undone = std::max(undone, PositionError(rolling, "features"));
      ignored = std::max(ignored,
                         PositionError(rolling, "features", ShutterUse::kNone));
    }
    EXPECT_LT(undone, 4.0 * global) << path;
    EXPECT_GT(ignored, 3.0 * undone) << path;
  }
}

// The first two depth images are 63 ms apart, their colour images 33 ms.
// Without correction, the first motion has an alternating error.
TEST(ShutterTrackingTest, OffsetsThatAlternate) {
  const auto first_error = [](ShutterUse use) {
    SyntheticOptions options;
    options.path = "xyz";
    options.noise = false;
    options.depth_delay_s = -0.015;
    const SyntheticDataset early(options);
    options.depth_delay_s = 0.015;
    const SyntheticDataset late(options);
    OdometryOptions odometry_options;
    odometry_options.shutter = use;
    Odometry odometry =
        MakeOdometry(late.camera().camera, "tukey", odometry_options);
    odometry.Track(early.Read(112));
    const Rigid3d truth =
        early.WorldFromCam(112).Inverse() * early.WorldFromCam(113);
    const Rigid3d found = odometry.Track(late.Read(113)).world_from_cam;
    return (found.translation - truth.translation).norm();
  };
  EXPECT_LT(first_error(ShutterUse::kCamera),
            0.1 * first_error(ShutterUse::kNone));
}

// Except for covariances, which include the error of an ignored shutter.
TEST(ShutterTrackingTest, GlobalShuttersGiveTheSameBytesEitherWay) {
  const ShutterSequence sequence("handheld", {}, 15);
  for (const std::string& tracker : TrackerNames()) {
    Odometry used = OdometryFor(sequence, tracker, ShutterUse::kCamera);
    Odometry ignored = OdometryFor(sequence, tracker, ShutterUse::kNone);
    for (const Frame& frame : sequence.frames) {
      const TrackedFrame a = used.Track(frame), b = ignored.Track(frame);
      EXPECT_FALSE(used.last_twist().has_value());
      EXPECT_FALSE(ignored.last_twist().has_value());
      EXPECT_EQ(a.world_from_cam, b.world_from_cam) << tracker;
      ASSERT_EQ(a.edges.size(), b.edges.size()) << tracker;
      for (size_t k = 0; k < a.edges.size(); ++k) {
        EXPECT_EQ(a.edges[k].cur_from_ref, b.edges[k].cur_from_ref) << tracker;
      }
    }
  }
}

// After a gap, the first frame has no velocity; the second has the first one's.
// After a loss, the first frame uses its rows and the last velocity.
TEST(ShutterTrackingTest, AGapForgetsTheVelocityALossDoesNot) {
  const ShutterSequence sequence("xyz", RollingShutters(1.0), 12);
  for (const bool is_loss : {false, true}) {
    Odometry odometry = OdometryFor(sequence, "features", ShutterUse::kCamera);
    for (int i = 0; i < 12; ++i) {
      Frame frame = sequence.frames[i];
      if (is_loss && i == 6) {
        frame = Black(frame);
        frame.depth = cv::Mat(frame.depth.size(), CV_16UC1, cv::Scalar(0));
      }
      if (!is_loss && i > 6) frame.timestamp += 0.5;
      const TrackedFrame tracked = odometry.Track(frame);
      const bool is_lost = is_loss && i == 6;
      EXPECT_EQ(tracked.status == TrackingStatus::kLost, is_lost) << i;
      EXPECT_EQ(odometry.last_twist().has_value(),
                i != 0 && !is_lost && (is_loss || i != 7))
          << i;
    }
  }
}

TEST(ShutterTrackingTest, ALongGapAfterTheFirstFrameTellsNoVelocity) {
  const ShutterSequence sequence("xyz", RollingShutters(1.0), 2);
  Odometry odometry = OdometryFor(sequence, "features", ShutterUse::kCamera);
  odometry.Track(sequence.frames[0]);
  Frame later = sequence.frames[1];
  later.timestamp += 10.0;
  EXPECT_EQ(odometry.Track(later).status, TrackingStatus::kOk);
  EXPECT_FALSE(odometry.last_twist().has_value());
}

// A camera with few frames, or a program that misses some.
TEST(ShutterTrackingTest, OfEveryFourthFrame) {
  ShutterSequence sequence("handheld", RollingShutters(1.0), 0);
  for (int i = 0; i < 120; i += 4) {
    sequence.frames.push_back(sequence.dataset.Read(i));
  }
  for (const char* const tracker : {"features", "hybrid"}) {
    EXPECT_LT(PositionError(sequence, tracker),
              0.3 * PositionError(sequence, tracker, ShutterUse::kNone))
        << tracker;
  }
}

// A reference without shutter between frames with shutters is not changed by
// data of the last reference with a shutter.
TEST(ShutterTrackingTest, ReferencesOfOneMomentAreNotMended) {
  const SyntheticDataset global(ShutterOptions("handheld", {}));
  const SyntheticDataset rolling(
      ShutterOptions("handheld", RollingShutters(1.0)));
  OdometryOptions options;
  options.max_flow_px = 1.0;  // every frame is a reference
  Odometry odometry(options,
                    MakeTracker("features", PartsFor(global.camera().camera)));
  odometry.Track(rolling.Read(30));
  ASSERT_TRUE(odometry.Track(global.Read(32)).is_reference);
  const TrackedFrame tracked = odometry.Track(rolling.Read(34));
  ASSERT_EQ(tracked.status, TrackingStatus::kOk) << tracked.reason;
  ASSERT_EQ(tracked.reference, 1);
  const Rigid3d truth =
      global.WorldFromCam(34).Inverse() * global.WorldFromCam(32);
  ASSERT_GT(truth.translation.norm(), 0.02) << "nothing moves";
  EXPECT_LT(ErrorOf(tracked.cur_from_reference, truth).translation, 0.005);
}

// A frame of another place starts a segment; the next one is found again in an
// earlier keyframe. The velocity found there is not that of the other place.
TEST(ShutterTrackingTest, ARelocalisationEndsTheWaitForAVelocity) {
  const ShutterSequence sequence("handheld", RollingShutters(1.0), 14);
  SyntheticOptions elsewhere = ShutterOptions("handheld", RollingShutters(1.0));
  elsewhere.scene = "corridor";
  constexpr int kOther = 10;
  Odometry odometry = OdometryFor(sequence, "hybrid", ShutterUse::kCamera);
  int keyframe = -1;
  std::optional<Twist> twist;
  Rigid3d reference_from_stamp;
  for (int i = 0; i < static_cast<int>(sequence.frames.size()); ++i) {
    Frame frame = sequence.frames[i];
    if (i == kOther) {
      frame = SyntheticDataset(elsewhere).Read(i);
      frame.timestamp = sequence.frames[i].timestamp;
    }
    const TrackedFrame tracked = odometry.Track(frame);
    if (i == kOther + 1) {
      ASSERT_TRUE(tracked.relocalised) << tracked.reason;
      keyframe = tracked.reference;
      const Keyframe& found = *odometry.FindKeyframe(keyframe);
      twist = found.frame.twist;
      ASSERT_TRUE(twist.has_value());
      reference_from_stamp = found.reference_from_stamp;
    }
    if (i > kOther + 1) {
      const Keyframe& kept = *odometry.FindKeyframe(keyframe);
      EXPECT_EQ(kept.frame.twist->angular, twist->angular);
      EXPECT_EQ(kept.frame.twist->linear, twist->linear);
      EXPECT_EQ(kept.reference_from_stamp.translation,
                reference_from_stamp.translation);
    }
  }
}

// Rows tell the velocity relative to that of the reference only. Nothing is
// known of that of a first frame: so if the next frame shows another place and
// the one after it is found again there, both may have it.
TEST(ShutterTrackingTest, ARelocalisedFrameMayMoveAsItsReferenceDoes) {
  const ShutterSequence sequence("handheld", RollingShutters(1.0), 3);
  SyntheticOptions elsewhere = ShutterOptions("handheld", RollingShutters(1.0));
  elsewhere.scene = "corridor";
  OdometryOptions options;
  options.max_flow_px = 1.0;  // every frame is a reference
  Odometry odometry(
      options,
      MakeTracker("hybrid", PartsFor(sequence.dataset.camera().camera)));
  odometry.Track(sequence.frames[0]);
  odometry.Track(SyntheticDataset(elsewhere).Read(1));
  const TrackedFrame back = odometry.Track(sequence.frames[2]);
  ASSERT_TRUE(back.relocalised) << back.reason;
  ASSERT_TRUE(back.is_reference) << back.reason;
  ASSERT_EQ(back.reference, 0);
  const auto variance = [&](int frame) {
    return odometry.FindKeyframe(frame)->velocity_covariance.trace();
  };
  // The velocity of a hand is limited: this halves it.
  EXPECT_GT(variance(2), 0.4 * variance(0));
}

}  // namespace
}  // namespace rgbd_pose
