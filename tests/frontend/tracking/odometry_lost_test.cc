// Handling of lost frames and of the frames after them.

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "frontend/tracking/odometry.h"
#include "tests/support/motions.h"
#include "tests/support/rendered_once.h"
#include "tests/support/track_sequence.h"

namespace rgbd_pose {
namespace {

// Two views of the room with nothing in common, each for a moment, with
// darkness between them; tested with each policy.
class LostPolicyTest : public ::testing::Test {
 protected:
  LostPolicyTest() {
    SyntheticOptions options = RoomOptions("xyz", 8);
    here_.emplace(options);
    options.path_from_cam = Turned(M_PI, Eigen::Vector3d::UnitY());
    elsewhere_.emplace(options);
  }

  // Frames 0-7 here, 8 and 9 dark, then elsewhere from 10 on, 0.5 s apart.
  std::vector<TrackedFrame> Run(LostPolicy policy, int frames) {
    OdometryOptions options;
    options.on_lost = policy;
    options.new_segment_after = 1.0;
    Odometry odometry = MakeOdometry(here_->camera().camera, "tukey", options);
    std::vector<TrackedFrame> results;
    for (int i = 0; i < frames; ++i) {
      Frame frame =
          i < 8 ? here_->Read(i)
                : TakenAgain(
                      i < 10 ? Black(here_->Read(7)) : elsewhere_->Read(0), i);
      frame.index = i;
      frame.timestamp = i < 8 ? i / 30.0 : 0.25 + 0.5 * (i - 8);
      results.push_back(odometry.Track(frame));
    }
    return results;
  }

  std::optional<SyntheticDataset> here_, elsewhere_;
};

TEST_F(LostPolicyTest, HoldKeepsTheLastPose) {
  const auto frames = Run(LostPolicy::kHold, 14);
  ASSERT_EQ(frames[7].status, TrackingStatus::kOk);
  for (int i = 8; i < 14; ++i) {
    EXPECT_EQ(frames[i].status, TrackingStatus::kLost) << i;
    EXPECT_NE(frames[i].reason, "") << i;
    EXPECT_EQ(frames[i].world_from_cam.translation,
              frames[7].world_from_cam.translation);
    EXPECT_EQ(frames[i].segment, 0);
  }
}

TEST_F(LostPolicyTest, PredictMovesOn) {
  const auto frames = Run(LostPolicy::kPredict, 10);
  const auto step_to = [&](int i) {
    return frames[i - 1].world_from_cam.Inverse() * frames[i].world_from_cam;
  };
  ASSERT_GT(step_to(7).translation.norm(), 1e-4) << "the test is vacuous";
  // Half of the time later; then after a time in which a hand changes its mind.
  for (int i = 8; i < 10; ++i) {
    EXPECT_EQ(frames[i].status, TrackingStatus::kLost);
    const Rigid3d off = step_to(i) * step_to(i) * step_to(7).Inverse();
    EXPECT_LE(off.translation.norm() + off.Angle(), 1e-5);
  }
}

TEST_F(LostPolicyTest, PredictsAtTheSameSpeedAfterMissingFrames) {
  OdometryOptions options;
  options.on_lost = LostPolicy::kPredict;
  Odometry odometry = MakeOdometry(here_->camera().camera, "tukey", options);
  Rigid3d last;
  double moved[8] = {};
  for (const int i : {0, 1, 2, 6, 7}) {  // three are missing, 7 is dark
    Frame frame = i < 7 ? here_->Read(i) : Black(here_->Read(i));
    frame.timestamp = i / 30.0;
    const Rigid3d pose = odometry.Track(frame).world_from_cam;
    moved[i] = (last.Inverse() * pose).translation.norm();
    last = pose;
  }
  EXPECT_GT(moved[6], 1e-4) << "the test is vacuous";
  EXPECT_NEAR(moved[7], moved[6] / 4.0, 0.1 * moved[6]);
}

TEST_F(LostPolicyTest, StopNeverComesBack) {
  OdometryOptions options;
  options.on_lost = LostPolicy::kStop;
  Odometry odometry = MakeOdometry(here_->camera().camera, "tukey", options);
  const Frame good = here_->Read(0);
  EXPECT_EQ(odometry.Track(good).status, TrackingStatus::kOk);
  EXPECT_EQ(odometry.Track(Black(good)).status, TrackingStatus::kLost);
  const TrackedFrame after = odometry.Track(good);
  EXPECT_EQ(after.status, TrackingStatus::kLost);
  EXPECT_NE(after.reason.find("stopped"), std::string::npos) << after.reason;
}

TEST_F(LostPolicyTest, ANewSegmentStartsWhereTheOldOneEnded) {
  const auto frames = Run(LostPolicy::kNewSegment, 14);
  EXPECT_EQ(frames[9].status, TrackingStatus::kLost) << "dark";
  EXPECT_EQ(frames[10].status, TrackingStatus::kDegraded) << frames[10].reason;
  EXPECT_EQ(frames[10].segment, 1);
  EXPECT_EQ(frames[10].reference, -1);
  EXPECT_EQ(frames[10].world_from_cam.translation,
            frames[7].world_from_cam.translation);
  EXPECT_EQ(frames[11].status, TrackingStatus::kDegraded) << frames[11].reason;
  EXPECT_NE(frames[11].reason.find("previous segment"), std::string::npos);
  EXPECT_EQ(frames[11].segment, 1);
  EXPECT_EQ(frames[11].reference, 10);
  // The previous segment is searched for during one second.
  EXPECT_EQ(frames[13].status, TrackingStatus::kOk) << frames[13].reason;
  EXPECT_EQ(frames[13].segment, 1);
}

// The view of a camera rotated on the spot.
Frame ViewTurned(double deg) {
  SyntheticOptions options = RoomOptions("still", 1);
  options.path_from_cam = Turned(deg * M_PI / 180.0, Eigen::Vector3d::UnitY());
  return SyntheticDataset(options).Read(0);
}

TEST(OdometryTest, AFrameIsLostIfNoMotionTiesItToTheOneBefore) {
  Odometry odometry = MakeOdometry(Room("still", 1).camera().camera, "tukey");
  const TrackingStatus expected[] = {
      TrackingStatus::kOk, TrackingStatus::kDegraded, TrackingStatus::kLost,
      TrackingStatus::kLost};
  for (int i = 0; i < 4; ++i) {
    Frame frame = ViewTurned(90.0 * i);
    frame.index = i;
    frame.timestamp += 0.1 * i;
    EXPECT_EQ(odometry.Track(frame).status, expected[i]) << i;
  }
}

// The camera jumps to a new place and turns back from there, frame by frame.
TEST(OdometryTest, TheWayBackToASegmentIsTrackedAndJoinsBoth) {
  const Camera camera = Room("still", 1).camera().camera;
  Odometry odometry = MakeOdometry(camera, "tukey");
  ASSERT_EQ(odometry.Track(ViewTurned(0.0)).status, TrackingStatus::kOk);
  const int first_turn = 60, step = 4;
  TrackedFrame result;
  int index = 1;
  for (int deg = first_turn; deg >= 20; deg -= step, ++index) {
    Frame frame = ViewTurned(deg);
    frame.index = index;
    frame.timestamp += 0.05 * index;
    result = odometry.Track(frame);
    ASSERT_NE(result.status, TrackingStatus::kLost) << result.reason;
    EXPECT_EQ(result.status == TrackingStatus::kOk, result.segment == 0);
    EXPECT_TRUE(deg != first_turn || result.segment == 1);
    if (result.segment == 1) continue;
    // The motions since one frame of each segment.
    EXPECT_TRUE(result.relocalised);
    ASSERT_EQ(result.edges.size(), 2u);
    EXPECT_EQ(result.edges[0].ref, 0);
    EXPECT_GT(result.edges[1].ref, 0);
    EXPECT_NEAR(result.world_from_cam.Angle(), deg * M_PI / 180.0, 2e-3);
    EXPECT_LE(result.world_from_cam.translation.norm(), 0.005);
    return;
  }
  FAIL() << "still in segment " << result.segment << ": " << result.reason;
}

TEST_F(LostPolicyTest, TheOldSegmentIsTakenUpAgainIfTheViewReturns) {
  OdometryOptions options;
  Odometry odometry = MakeOdometry(here_->camera().camera, "tukey", options);
  Frame frame = here_->Read(0);
  odometry.Track(frame);
  for (int i = 1; i < 6; ++i) {
    Frame dark = Black(frame);
    dark.index = i;
    dark.timestamp = frame.timestamp + 0.2 * i;
    EXPECT_EQ(odometry.Track(dark).status, TrackingStatus::kLost);
  }
  Frame moved = here_->Read(7);
  moved.index = 6;
  moved.timestamp = frame.timestamp + 1.2;
  const TrackedFrame back = odometry.Track(moved);
  EXPECT_EQ(back.status, TrackingStatus::kOk) << back.reason;
  EXPECT_EQ(back.segment, 0);
  const Rigid3d expected =
      here_->WorldFromCam(0).Inverse() * here_->WorldFromCam(7);
  EXPECT_LE((back.world_from_cam.translation - expected.translation).norm(),
            0.003);
}

// Half a second of darkness, with wheel odometry that continues.
class DarknessTest : public ::testing::TestWithParam<LostPolicy> {
 protected:
  static constexpr int kFrames = 40;
  static constexpr int kDark = 15, kLight = 30;

  // `told(i)`: whether the motion up to frame i is known.
  std::vector<TrackedFrame> Run(const std::function<bool(int)>& told) {
    OdometryOptions options;
    options.on_lost = GetParam();
    Odometry odometry = MakeOdometry(room_.camera().camera, "tukey", options);
    std::vector<TrackedFrame> frames;
    for (int i = 0; i < kFrames; ++i) {
      const Frame frame = room_.Read(i);
      Rigid3d guess;
      if (i > 0)
        guess = room_.WorldFromCam(i).Inverse() * room_.WorldFromCam(i - 1);
      frames.push_back(
          odometry.Track(i >= kDark && i < kLight ? Black(frame) : frame,
                         i > 0 && told(i) ? &guess : nullptr));
    }
    return frames;
  }
  Rigid3d Truth(int i) const {
    return room_.WorldFromCam(0).Inverse() * room_.WorldFromCam(i);
  }
  double ErrorOf(const TrackedFrame& frame) const {
    return (Truth(frame.index).Inverse() * frame.world_from_cam)
        .translation.norm();
  }

  static const RenderedOnce& Circle() {
    static const RenderedOnce room(RoomOptions("circle", 120));
    return room;
  }

  const RenderedOnce& room_ = Circle();
};

TEST_P(DarknessTest, AMotionGuessIsFollowedAndSaidToBe) {
  const std::vector<TrackedFrame> frames = Run([](int) { return true; });
  const Rigid3d moved = Truth(kDark - 1).Inverse() * Truth(kLight - 1);
  ASSERT_GT(moved.translation.norm(), 0.1) << "the test is vacuous";
  for (const TrackedFrame& frame : frames) {
    EXPECT_LE(ErrorOf(frame), 0.005) << frame.index;
    const bool dark = frame.index >= kDark && frame.index < kLight;
    EXPECT_EQ(frame.status == TrackingStatus::kLost, dark) << frame.reason;
    EXPECT_EQ(frame.is_predicted, dark);
    if (!dark) continue;
    // The covariance in the dark is the sum of the steps' covariances.
    ASSERT_EQ(frame.edges.size(), 1u);
    const RelativePose& edge = frame.edges[0];
    const int steps = frame.index - kDark + 1;
    EXPECT_NEAR(edge.covariance(0, 0), steps * 1e-4, 1e-5);
    EXPECT_GE(edge.covariance(3, 3), steps * 1e-4);
    const Rigid3d pose =
        frames[edge.ref].world_from_cam * edge.cur_from_ref.Inverse();
    EXPECT_LE((pose.Inverse() * frame.world_from_cam).translation.norm(),
              1e-12);
  }
}

TEST_P(DarknessTest, AGapInTheGuessEndsThePrediction) {
  const std::vector<TrackedFrame> frames =
      Run([](int i) { return i != kDark + 5; });
  for (int i = kDark; i < kLight; ++i) {
    EXPECT_EQ(frames[i].is_predicted, i < kDark + 5) << i;
    EXPECT_EQ(frames[i].edges.empty(), i >= kDark + 5) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Policies, DarknessTest,
                         ::testing::Values(LostPolicy::kHold,
                                           LostPolicy::kPredict,
                                           LostPolicy::kNewSegment));

// A room ten times as large, beyond the default depth range, left and entered
// again with the camera rotated.
TEST(OdometryTest, WhatIsSaidOfDepthsReachesTheRelocaliser) {
  SyntheticOptions options = RoomOptions("still", 2);
  const SyntheticDataset here(options);
  options.path_from_cam = Turned(0.4, Eigen::Vector3d::UnitY());
  const SyntheticDataset turned(options);
  FrontendOptions frontend{here.camera().camera};
  frontend.depth.max_depth = 100.0;
  Odometry odometry(
      {},
      MakeTracker("features",
                  {{}, frontend, "patch", Estimator({}, MakeRobustCosts())}));
  const auto larger = [](Frame frame) {
    frame.depth_scale /= 10.0;
    return frame;
  };
  ASSERT_EQ(odometry.Track(larger(here.Read(0))).status, TrackingStatus::kOk);
  EXPECT_EQ(odometry.Track(Black(larger(here.Read(1)))).status,
            TrackingStatus::kLost);
  const TrackedFrame found = odometry.Track(larger(turned.Read(1)));
  EXPECT_EQ(found.status, TrackingStatus::kOk) << found.reason;
}

}  // namespace
}  // namespace rgbd_pose
