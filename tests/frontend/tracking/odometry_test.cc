// The whole chain in memory: images in, poses out.

#include "frontend/tracking/odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "core/util/input_error.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/sources/camera_file.h"
#include "frontend/sources/tum_dataset.h"

namespace rgbd_pose {
namespace {

Odometry MakeOdometry(const Camera& camera, const std::string& loss,
                      const OdometryOptions& options = {}) {
  FrontendOptions frontend;
  frontend.camera = camera;
  return Odometry(options, MakeFrontend("patch", frontend),
                  Estimator(EstimatorOptions(),
                            MakeRobustCosts("bidirectional_point", loss)));
}

struct Tracked {
  std::vector<TrackedFrame> frames;
  Trajectory trajectory;

  int Count(TrackingStatus status) const {
    int count = 0;
    for (const TrackedFrame& frame : frames) count += frame.status == status;
    return count;
  }
};

Tracked TrackAll(const Dataset& dataset, const std::string& loss,
                 const OdometryOptions& options = {}) {
  Odometry odometry = MakeOdometry(dataset.camera().camera, loss, options);
  Tracked run;
  for (int i = 0; i < dataset.size(); ++i) {
    run.frames.push_back(odometry.Track(dataset.Read(i)));
    run.trajectory.push_back(
        {run.frames.back().timestamp, run.frames.back().world_from_cam});
  }
  return run;
}

SyntheticDataset Room(const std::string& path, int frames) {
  SyntheticOptions options;
  options.path = path;
  options.frames = frames;
  return SyntheticDataset(options);
}

// A matrix of its own: assigning cv::Mat::zeros would write into the shared
// one.
Frame Black(const Frame& frame) {
  Frame black = frame;
  black.gray = cv::Mat(frame.gray.size(), CV_8UC1, cv::Scalar(0));
  return black;
}

TEST(OdometryOptionsTest, NoFieldMayBeNan) {
  for (double OdometryOptions::*field :
       {&OdometryOptions::min_reference_share, &OdometryOptions::max_flow_px,
        &OdometryOptions::new_segment_after}) {
    OdometryOptions options;
    options.*field = std::nan("");
    EXPECT_THROW(MakeOdometry(Camera(), "tukey", options), InputError);
  }
  for (double TrackerOptions::*field :
       {&TrackerOptions::min_inlier_share_ok, &TrackerOptions::max_sigma_ok,
        &TrackerOptions::prior_sigma_rotation,
        &TrackerOptions::prior_sigma_translation}) {
    TrackerOptions options;
    options.*field = std::nan("");
    EXPECT_NE(options.Check(), "");
  }
}

TEST(OdometryTest, FollowsTheCameraAlongItsAxes) {
  const SyntheticDataset dataset = Room("xyz", 30);
  const Tracked run = TrackAll(dataset, "tukey");
  EXPECT_EQ(run.Count(TrackingStatus::kOk), 30);
  const EvaluationReport report =
      Evaluate(run.trajectory, dataset.ground_truth(), {});
  // Ten times below the path's length would already be a failure to track;
  // 5 mm is what the whole sequence is held to.
  EXPECT_LE(report.ate.rmse, 0.005);
  // Directions: the pose itself, not its inverse, to within the drift.
  const Rigid3d first = dataset.WorldFromCam(0);
  const Rigid3d expected = first.Inverse() * dataset.WorldFromCam(29);
  const Rigid3d actual = run.trajectory.back().world_from_cam;
  ASSERT_GT(expected.translation.norm(), 0.03) << "the path is vacuous";
  EXPECT_LE((actual.translation - expected.translation).norm(), 0.005);
}

// Depth of 15 ms earlier or later is at the wrong place by up to 10 px here.
TEST(OdometryTest, UndoesTheOffsetOfTheDepthStamps) {
  const auto position_error = [](double delay, bool ignore) {
    SyntheticOptions options;
    options.path = "handheld";
    options.frames = 40;
    options.camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5};
    options.depth_delay_s = delay;
    const SyntheticDataset dataset(options);
    OdometryOptions odometry_options;
    odometry_options.ignore_stamp_offset = ignore;
    const Tracked run = TrackAll(dataset, "tukey", odometry_options);
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
TEST(OdometryTest, UndoesOffsetsThatAlternate) {
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

TEST(OdometryTest, ComesBackFromPanAndTilt) {
  const SyntheticDataset dataset = Room("pan_tilt", 60);
  for (const std::string loss : {"huber", "tukey"}) {
    const Tracked run = TrackAll(dataset, loss);
    EXPECT_EQ(run.Count(TrackingStatus::kLost), 0) << loss;
    const Rigid3d end = run.trajectory.back().world_from_cam;
    EXPECT_LE(end.Angle(), 0.3 * M_PI / 180.0) << loss;
    EXPECT_LE(end.translation.norm(), 0.005) << loss;
  }
}

TEST(OdometryTest, StandsStill) {
  const Tracked run = TrackAll(Room("still", 20), "tukey");
  for (const TrackedFrame& frame : run.frames) {
    EXPECT_EQ(frame.status, TrackingStatus::kOk) << frame.reason;
    EXPECT_LE(frame.world_from_cam.translation.norm(), 0.002);
    EXPECT_LE(frame.world_from_cam.Angle(), 0.1 * M_PI / 180.0);
  }
}

TEST(OdometryTest, EveryFrameGetsAResultAndBlackOnesAreLost) {
  const SyntheticDataset dataset = Room("still", 1);
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  const Frame good = dataset.Read(0);
  const Frame black = Black(good);
  Frame blind = good;
  blind.depth = cv::Mat(good.depth.size(), CV_16UC1, cv::Scalar(0));

  EXPECT_EQ(odometry.Track(good).status, TrackingStatus::kOk);
  EXPECT_EQ(odometry.Track(good).status, TrackingStatus::kOk);
  for (const Frame& bad : {black, blind, black}) {
    const TrackedFrame result = odometry.Track(bad);
    EXPECT_EQ(result.status, TrackingStatus::kLost);
    EXPECT_NE(result.reason, "");
    EXPECT_LE(result.world_from_cam.translation.norm(), 0.001) << "not held";
  }
  odometry.Track(good);  // the new reference
  EXPECT_EQ(odometry.Track(good).status, TrackingStatus::kOk);
}

TEST(OdometryTest, ABlackStartIsLostUntilThereAreFeatures) {
  const SyntheticDataset dataset = Room("still", 1);
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  const Frame good = dataset.Read(0);
  const Frame black = Black(good);
  EXPECT_EQ(odometry.Track(black).status, TrackingStatus::kLost);
  EXPECT_EQ(odometry.Track(black).status, TrackingStatus::kLost);
  EXPECT_EQ(odometry.Track(good).status, TrackingStatus::kOk);
  EXPECT_EQ(odometry.Track(good).status, TrackingStatus::kOk);
}

// Two views of the room that have nothing in common, each a moment long, with
// darkness between: what each policy makes of it.
class LostPolicyTest : public ::testing::Test {
 protected:
  LostPolicyTest() {
    SyntheticOptions options;
    options.path = "xyz";
    options.frames = 8;
    here_.emplace(options);
    options.path_from_cam = Rigid3d(
        Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY())),
        Eigen::Vector3d::Zero());
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
      Frame frame = i < 8    ? here_->Read(i)
                    : i < 10 ? Black(here_->Read(7))
                             : elsewhere_->Read(0);
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
  const Rigid3d step =
      frames[6].world_from_cam.Inverse() * frames[7].world_from_cam;
  for (int i = 8; i < 10; ++i) {
    EXPECT_EQ(frames[i].status, TrackingStatus::kLost);
    const Rigid3d expected = frames[i - 1].world_from_cam * step;
    EXPECT_LE(
        (frames[i].world_from_cam.translation - expected.translation).norm(),
        1e-9);
  }
  EXPECT_GT(step.translation.norm(), 1e-4) << "the test is vacuous";
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
  EXPECT_EQ(frames[11].status, TrackingStatus::kOk) << frames[11].reason;
  EXPECT_EQ(frames[11].segment, 1);
  EXPECT_EQ(frames[11].reference, 10);
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

// The second frame is far from the first: only who is told finds it at once.
TEST(OdometryTest, AMotionGuessIsTriedFirst) {
  const SyntheticDataset dataset = Room("pan_tilt", 40);
  const Frame first = dataset.Read(0);
  const Frame second = dataset.Read(8);
  const Rigid3d truth =
      dataset.WorldFromCam(8).Inverse() * dataset.WorldFromCam(0);
  ASSERT_GT(truth.Angle(), 3.0 * M_PI / 180.0) << "the test is vacuous";
  const Rigid3d wrong = truth.Inverse();
  for (const Rigid3d& guess : {truth, wrong}) {
    Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
    odometry.Track(first);
    const TrackedFrame tracked = odometry.Track(second, &guess);
    EXPECT_EQ(tracked.status, TrackingStatus::kOk) << tracked.reason;
    const Rigid3d error = truth * tracked.world_from_cam;
    EXPECT_LE(error.translation.norm(), 0.01) << "believed a wrong guess";
    EXPECT_LE(error.Angle(), 0.3 * M_PI / 180.0);
  }
}

// A camera that has passed its way before: references change, also to earlier
// ones. Nobody numbers the frames.
// Half a second of darkness, with wheels that go on counting.
class DarknessTest : public ::testing::TestWithParam<LostPolicy> {
 protected:
  static constexpr int kFrames = 40;
  static constexpr int kDark = 15, kLight = 30;

  // `told(i)`: whether the motion up to frame i is.
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

  SyntheticDataset room_ = Room("circle", 120);
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
    // The way of the darkness is as uncertain as its steps together.
    ASSERT_EQ(frame.edges.size(), 1u);
    const Edge& edge = frame.edges[0];
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

TEST(OdometryTest, EveryTrackedFrameCarriesItsEdges) {
  const SyntheticDataset dataset = Room("pan_tilt", 60);
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  std::vector<TrackedFrame> frames;
  int references = 0, returns = 0;
  for (int i = 0; i < dataset.size(); ++i) {
    Frame frame = dataset.Read(i);
    frame.index = 0;
    frames.push_back(odometry.Track(frame));
    const TrackedFrame& tracked = frames.back();
    ASSERT_EQ(tracked.index, i);
    ASSERT_EQ(tracked.edges.empty(), i == 0) << i;
    references += tracked.is_reference;
    returns += tracked.edges.size() > 1;
    for (size_t k = 0; k < tracked.edges.size(); ++k) {
      const Edge& edge = tracked.edges[k];
      EXPECT_EQ(edge.cur, i);
      ASSERT_LT(edge.ref, i);
      EXPECT_TRUE(frames[edge.ref].is_reference);
      EXPECT_GT(edge.covariance.ldlt().vectorD().minCoeff(), 0.0);
      const Rigid3d truth =
          dataset.WorldFromCam(i).Inverse() * dataset.WorldFromCam(edge.ref);
      const Rigid3d error = edge.cur_from_ref * truth.Inverse();
      EXPECT_LE(error.translation.norm(), 0.005) << i;
      EXPECT_LE(error.Angle(), 0.3 * M_PI / 180.0) << i;
      if (k > 0) continue;
      EXPECT_EQ(edge.ref, tracked.reference);
      const Rigid3d pose =
          frames[edge.ref].world_from_cam * edge.cur_from_ref.Inverse();
      EXPECT_LE((pose.Inverse() * tracked.world_from_cam).translation.norm(),
                1e-12);
    }
  }
  EXPECT_GE(references, 5) << "the test is vacuous";
  EXPECT_GE(returns, 1) << "the test is vacuous";
}

// A room ten times as large, beyond the depths that are used by default, left
// and entered again with the camera turned.
TEST(OdometryTest, WhatIsSaidOfDepthsReachesTheRelocaliser) {
  SyntheticOptions options;
  options.path = "still";
  options.frames = 2;
  const SyntheticDataset here(options);
  options.path_from_cam = Rigid3d(
      Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY())),
      Eigen::Vector3d::Zero());
  const SyntheticDataset turned(options);
  FrontendOptions frontend{here.camera().camera};
  frontend.max_depth = 100.0;
  Odometry odometry({}, MakeFrontend("patch", frontend),
                    {{}, MakeRobustCosts()});
  const auto larger = [](Frame frame) {
    frame.depth_scale /= 10.0;
    return frame;
  };
  ASSERT_EQ(odometry.Track(larger(here.Read(0))).status, TrackingStatus::kOk);
  EXPECT_EQ(odometry.Track(Black(larger(here.Read(1)))).status,
            TrackingStatus::kLost);
  const TrackedFrame found = odometry.Track(larger(turned.Read(1)));
  EXPECT_EQ(found.status, TrackingStatus::kOk) << found.reason;
  EXPECT_TRUE(found.relocalised);
}

TEST(OdometryTest, GivesTheSameBytesTwice) {
  const SyntheticDataset dataset = Room("xyz", 12);
  EXPECT_EQ(FormatTrajectory(TrackAll(dataset, "tukey").trajectory),
            FormatTrajectory(TrackAll(dataset, "tukey").trajectory));
}

class RealSequenceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("RGBD_POSE_TEST_DATA");
    if (folder == nullptr) {
      GTEST_SKIP() << "RGBD_POSE_TEST_DATA does not name a folder of real "
                      "sequences";
    }
    folder_ = folder;
  }

  TumDataset Open(const std::string& sequence) const {
    SourceOptions options;
    options.path = folder_ + "/" + sequence;
    options.camera = ResolveCamera(options.path + "/camera.yaml");
    return TumDataset(options);
  }

  std::string folder_;
};

TEST_F(RealSequenceTest, RedKitchenIsTrackedThroughout) {
  const Tracked run = TrackAll(Open("redkitchen400"), "tukey");
  EXPECT_EQ(run.frames.size(), 400u);
  EXPECT_EQ(run.Count(TrackingStatus::kLost), 0);
  const EvaluationReport report =
      Evaluate(run.trajectory,
               ReadTrajectory(folder_ + "/redkitchen400/groundtruth.txt"), {});
  EXPECT_LE(report.ate.rmse, 0.060);
  EXPECT_LE(report.rpe_seconds.translation.rmse, 0.050);
}

TEST_F(RealSequenceTest, AFarHallIsNotLostAndStandsStill) {
  const Tracked run = TrackAll(Open("tum_fr2_hall50"), "tukey");
  EXPECT_EQ(run.Count(TrackingStatus::kLost), 0);
}

TEST_F(RealSequenceTest, FastRotationIsTracked) {
  const Tracked run = TrackAll(Open("tum_fr1_360_5"), "tukey");
  EXPECT_EQ(run.Count(TrackingStatus::kLost), 0);
}

TEST_F(RealSequenceTest, Freiburg1IsWithinAFewMillimetres) {
  // The depth stamps are partly guessed (SOURCE.txt), the third one wrongly: as
  // it stands its frame fits worse than with none, one image later better.
  OdometryOptions options;
  options.ignore_stamp_offset = true;
  const Tracked run = TrackAll(Open("tum_fr1_xyz_3"), "tukey", options);
  EXPECT_EQ(run.Count(TrackingStatus::kOk), 3);
  const EvaluationReport report =
      Evaluate(run.trajectory,
               ReadTrajectory(folder_ + "/tum_fr1_xyz_3/groundtruth.txt"), {});
  EXPECT_LE(report.rpe_frame.translation.rmse, 0.01);
}

}  // namespace
}  // namespace rgbd_pose
