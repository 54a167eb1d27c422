#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/tracking/direct_tracker.h"
#include "frontend/tracking/feature_tracker.h"
#include "frontend/tracking/odometry.h"
#include "frontend/tracking/tracker_factory.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/feature_wall.h"
#include "tests/support/motions.h"
#include "tests/support/rendered_once.h"
#include "tests/support/tracker_parts.h"

namespace rgbd_pose {
namespace {

TEST(ReferenceFeaturesTest, SaysWhatAnotherCameraSeesOfIt) {
  const ReferenceFeatures wall = FeatureWall();
  // 525 px / 2 m: a metre is 262.5 px, and 9 of the 15 columns are left.
  const Overlap aside = wall.SeenFrom(Moved(-1.0, 0.0, 0.0));
  EXPECT_NEAR(aside.share, 9.0 / 15.0, 1e-12);
  EXPECT_NEAR(aside.flow_px, 262.5, 1e-9);
  // Nothing is in view behind the camera.
  const Rigid3d turned = Turned(M_PI, Eigen::Vector3d::UnitY());
  EXPECT_EQ(wall.SeenFrom(turned).share, 0.0);
}

// Finds every feature of the wall where it was, moved by `move`.
class WallFrontend final : public Frontend {
 public:
  using Move = std::function<void(size_t feature, Observation* found)>;

  explicit WallFrontend(Move move)
      : Frontend({kWallCamera}), move_(std::move(move)) {}
  std::unique_ptr<FeatureSet> Detect(const PreparedFrame&) override {
    return std::make_unique<FeatureSet>(*FeatureWall().features);
  }
  void Match(const FeatureSet& reference, const PreparedFrame&, const Rigid3d&,
             FeatureMatches* matches) override {
    matches->Clear();
    for (size_t i = 0; i < reference.observations.size(); ++i) {
      Observation found = reference.observations[i];
      move_(i, &found);
      matches->Add(reference, static_cast<int>(i), found);
    }
  }

 private:
  Move move_;
};

// Tracks the wall, seen by a camera that stands still.
TrackingResult TrackWall(const WallFrontend::Move& move) {
  FeatureTracker tracker(std::make_unique<WallFrontend>(move),
                         Estimator({}, MakeRobustCosts()));
  const PreparedFrame frame{Frame()};
  const auto reference = ReferenceOf(&tracker, frame);
  TrackingResult tracked(kWallCamera);
  tracker.Track(*reference, frame, Rigid3d(), &tracked);
  return tracked;
}

// Five of nine matches are off in any direction: the motion is right, but the
// spread is determined by the wrong ones.
TEST(FeatureTrackerTest, AMotionThatMostMatchesAreFarFromIsDoubtful) {
  for (const bool doubtful : {false, true}) {
    const double error_px = doubtful ? 30.0 : 0.0;
    const TrackingResult tracked = TrackWall([&](size_t i, Observation* found) {
      const double turn = 2.4 * static_cast<double>(i);
      if (i % 9 >= 5) return;
      found->u += error_px * std::cos(turn);
      found->v += error_px * std::sin(turn);
    });
    EXPECT_GT(tracked.estimate.num_inliers, 60);
    EXPECT_LT(tracked.estimate.cur_from_prev.translation.norm(), 0.005);
    EXPECT_EQ(tracked.status,
              doubtful ? TrackingStatus::kDegraded : TrackingStatus::kOk)
        << tracked.estimate.sigma;
    EXPECT_EQ(tracked.reason.find("residuals are") == 0, doubtful)
        << tracked.reason;
  }
}

// Matches are a pixel off, in the same way in each quarter of the image.
TEST(FeatureTrackerTest, TheCovarianceIncludesWhatNeighboursHaveInCommon) {
  for (const bool is_uneven : {false, true}) {
    const double error_px = is_uneven ? 1.0 : 0.0;
    const TrackingResult tracked = TrackWall([&](size_t, Observation* found) {
      const bool is_right = (found->u < 320.0) == (found->v < 240.0);
      found->u += is_right ? error_px : -error_px;
    });
    const MotionMatrix alone = Estimator({}, MakeRobustCosts())
                                   .Estimate(tracked.matches.matches, Rigid3d())
                                   .covariance;
    const double factor = tracked.estimate.covariance.trace() / alone.trace();
    EXPECT_NEAR(factor, tracked.covariance_factor, 1e-3 * factor);
    EXPECT_EQ(factor > 1.5, is_uneven) << factor;
  }
}

class TrackerTest : public ::testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Tracker> Make(const TrackerOptions& options = {}) const {
    return MakeTracker(GetParam(), PartsFor(room_.camera().camera, options));
  }

  SyntheticDataset room_{SyntheticOptions()};
};

// The odometry relies on this for every tracker.
TEST_P(TrackerTest, FindsTheMotionAndSaysHowMuchIsShared) {
  const auto tracker = Make();
  const auto reference =
      ReferenceOf(tracker.get(), PreparedFrame(room_.Read(0)));
  TrackingResult tracked(tracker->images().camera);
  double share = 1.0, flow = 0.0;
  for (const int frame : {5, 15}) {
    tracker->Track(*reference, PreparedFrame(room_.Read(frame)), Rigid3d(),
                   &tracked);
    ASSERT_EQ(tracked.status, TrackingStatus::kOk) << tracked.reason;
    const Rigid3d truth =
        room_.WorldFromCam(frame).Inverse() * room_.WorldFromCam(0);
    const MotionEstimate& estimate = tracked.estimate;
    EXPECT_LE((estimate.cur_from_prev * truth.Inverse()).translation.norm(),
              0.003);
    EXPECT_GT(estimate.covariance.trace(), 0.0);
    EXPECT_LT(tracked.overlap.share, share);
    EXPECT_GT(tracked.overlap.flow_px, flow);
    share = tracked.overlap.share;
    flow = tracked.overlap.flow_px;
    // The measured flow is close to the one predicted from depth and motion.
    EXPECT_NEAR(reference->SeenFrom(truth).flow_px, flow, 0.1 * flow + 1.0);
  }
  EXPECT_GT(share, 0.5);
  EXPECT_FALSE(tracked.needs_new_keyframe);
}

// The covariance of a guess is used by costs with a prior.
TEST_P(TrackerTest, TrustsAGuessAsFarAsItsCovarianceGoes) {
  TrackerParts parts = PartsFor(room_.camera().camera);
  parts.estimator = Estimator(
      {}, MakeRobustCosts("bidirectional_point+motion_prior", "tukey,none"));
  const std::string cost = "photometric+motion_prior";
  parts.direct_estimators->leading =
      Estimator(DirectEstimatorOptions(), MakeDirectCosts(cost, "huber,none"));
  parts.direct_estimators->refining = Estimator(
      DirectEstimatorOptions(),
      JoinCosts(
          MakeRobustCosts("bidirectional_point+motion_prior", "tukey,none"),
          MakeDirectCosts(cost, "tukey,none")));
  const auto tracker = MakeTracker(GetParam(), std::move(parts));
  const auto reference =
      ReferenceOf(tracker.get(), PreparedFrame(room_.Read(0)));
  const PreparedFrame frame(room_.Read(3));
  const Rigid3d truth = room_.WorldFromCam(3).Inverse() * room_.WorldFromCam(0);
  TrackingResult tracked(tracker->images().camera);
  const auto pulled = [&](double sigma) {
    const MotionMatrix covariance = sigma * sigma * MotionMatrix::Identity();
    TrackingGuess guess = Moved(0.01, 0.0, 0.0) * truth;
    guess.covariance = &covariance;
    tracker->Track(*reference, frame, guess, &tracked);
    return (tracked.estimate.cur_from_prev * truth.Inverse())
        .translation.norm();
  };
  EXPECT_LE(pulled(1.0), 0.002);
  EXPECT_GE(pulled(1e-6), 0.009);
}

TEST_P(TrackerTest, SaysWhyAFrameIsNoReferenceOrNotTracked) {
  const auto tracker = Make();
  const Frame good = room_.Read(0);
  // Depth alone may be enough for trackers that use it.
  Frame black = good;
  black.gray = cv::Mat(good.gray.size(), CV_8UC1, cv::Scalar(0));
  black.depth = cv::Mat(good.depth.size(), CV_16UC1, cv::Scalar(0));
  std::string why_not;
  EXPECT_EQ(
      tracker->MakeReference(PreparedFrame(black), nullptr, nullptr, &why_not),
      nullptr);
  EXPECT_NE(why_not, "");
  const auto reference = ReferenceOf(tracker.get(), PreparedFrame(good));
  TrackingResult tracked(tracker->images().camera);
  tracker->Track(*reference, PreparedFrame(black), Rigid3d(), &tracked);
  EXPECT_EQ(tracked.status, TrackingStatus::kLost);
  EXPECT_NE(tracked.reason, "");
}

TEST_P(TrackerTest, RefusesOptionsThatAreNotSound) {
  TrackerOptions options;
  options.min_inliers_ok = options.min_inliers - 1;
  ExpectInputError([&] { Make(options); }, {"min_inliers_ok"});
}

INSTANTIATE_TEST_SUITE_P(Trackers, TrackerTest,
                         ::testing::ValuesIn(TrackerNames()),
                         [](const auto& info) { return info.param; });

TEST(TrackerFactoryTest, ListsTheNamesThereAre) {
  ExpectInputError([] { MakeTracker("none", PartsFor(Camera())); },
                   {"tracker", "none", "features", "direct", "hybrid"});
}

TEST(TrackerFactoryTest, PixelsNeedAnEstimatorOfTheirOwn) {
  for (const char* name : {"direct", "hybrid"}) {
    ExpectInputError(
        [name] {
          MakeTracker(name,
                      {{}, {}, "patch", Estimator({}, MakeRobustCosts())});
        },
        {"direct"});
  }
}

// For a path in a scene: the status of all frames and the last frame's error.
struct Tracks {
  int lost = 0;
  int by_pixels_alone = 0;
  double off = 0.0;    // m
  std::string reason;  // of the last lost frame
};

Tracks Follow(const char* tracker, const SyntheticDataset& dataset,
              const OdometryOptions& policy = {}) {
  Odometry odometry(policy,
                    MakeTracker(tracker, PartsFor(dataset.camera().camera)));
  Tracks tracks;
  for (int i = 0; i < dataset.size(); ++i) {
    const TrackedFrame frame = odometry.Track(dataset.Read(i));
    if (frame.status == TrackingStatus::kLost) {
      ++tracks.lost;
      tracks.reason = frame.reason;
    }
    tracks.by_pixels_alone += frame.source == TrackingSource::kDirect;
    const Rigid3d truth =
        dataset.WorldFromCam(0).Inverse() * dataset.WorldFromCam(i);
    if (frame.status == TrackingStatus::kOk) {
      tracks.off = (truth.Inverse() * frame.world_from_cam).translation.norm();
    }
  }
  return tracks;
}

TEST(DirectTrackerTest, IsNotLostWithoutTexture) {
  OdometryOptions hold;
  hold.on_lost = LostPolicy::kHold;
  const RenderedOnce room({"plain_room", "pan_tilt", 40});
  EXPECT_GT(Follow("features", room, hold).lost, 5);
  const Tracks direct = Follow("direct", room);
  EXPECT_EQ(direct.lost, 0);
  EXPECT_EQ(direct.by_pixels_alone, 39);
  EXPECT_LE(direct.off, 0.003);
  const Tracks hybrid = Follow("hybrid", room);
  EXPECT_EQ(hybrid.lost, 0);
  EXPECT_LE(hybrid.off, 0.003);
}

// A bare corridor gives no information along its axis; noise of slopes must not
// be used as such.
TEST(DirectTrackerTest, SaysWhichDirectionACorridorHides) {
  OdometryOptions hold;
  hold.on_lost = LostPolicy::kHold;
  const Tracks tracks =
      Follow("direct", SyntheticDataset({"corridor", "walk", 8}), hold);
  EXPECT_EQ(tracks.lost, 7);
  EXPECT_NE(tracks.reason.find("translation along z"), std::string::npos)
      << tracks.reason;
}

// A frame that is the same except for noise, without depth.
TEST(DirectTrackerTest, AFrameHasToLookLikeItsReference) {
  SyntheticOptions options;
  options.frames = 2;
  const SyntheticDataset room(options);
  Frame next = room.Read(0);
  next.gray = next.gray.clone();
  cv::Mat noise(next.gray.size(), CV_8UC1);
  cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 0, 30);
  next.gray += noise;
  next.depth = cv::Mat::zeros(next.depth.size(), CV_16UC1);
  for (const bool is_strict : {false, true}) {
    TrackerParts parts = PartsFor(room.camera().camera);
    if (is_strict) parts.options.min_likeness = 1.0;
    const auto tracker = MakeTracker("direct", std::move(parts));
    const auto reference =
        ReferenceOf(tracker.get(), PreparedFrame(room.Read(0)));
    TrackingResult tracked(room.camera().camera);
    tracker->Track(*reference, PreparedFrame(next), Rigid3d(), &tracked);
    EXPECT_EQ(tracked.status == TrackingStatus::kLost, is_strict)
        << tracked.reason;
    EXPECT_EQ(tracked.reason == "the image differs too much from its reference",
              is_strict);
  }
}

TEST(HybridTrackerTest, PixelsMakeMotionsMoreAccurate) {
  const RenderedOnce room({"room", "xyz", 12});
  const Tracks features = Follow("features", room);
  const Tracks hybrid = Follow("hybrid", room);
  EXPECT_EQ(hybrid.by_pixels_alone, 0);
  EXPECT_LE(hybrid.off, 0.7 * features.off)
      << hybrid.off << " against " << features.off;
}

TEST(TrackerOptionsTest, NoFieldMayBeNan) {
  for (double TrackerOptions::*field :
       {&TrackerOptions::min_inlier_share_ok, &TrackerOptions::max_sigma_ok,
        &TrackerOptions::min_seen_share, &TrackerOptions::min_likeness,
        &TrackerOptions::prior_sigma_rotation,
        &TrackerOptions::prior_sigma_translation}) {
    TrackerOptions options;
    EXPECT_EQ(options.Check(), "");
    options.*field = std::nan("");
    EXPECT_NE(options.Check(), "");
  }
}

}  // namespace
}  // namespace rgbd_pose
