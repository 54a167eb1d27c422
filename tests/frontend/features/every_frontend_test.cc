// Requirements for every frontend, whatever its features. A new frontend is
// tested as soon as it has a row in frontend/features/frontend.cc.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/tracking/feature_tracker.h"
#include "frontend/tracking/odometry.h"
#include "tests/support/matched_views.h"
#include "tests/support/rendered_once.h"

namespace rgbd_pose {
namespace {

class EveryFrontendTest : public MatchedViews,
                          public ::testing::TestWithParam<std::string> {
 protected:
  EveryFrontendTest() : MatchedViews(GetParam()) {}

  Frame Black() const {
    Frame frame = cur_;
    frame.gray = cv::Mat(frame.gray.size(), CV_8UC1, cv::Scalar(0));
    return frame;
  }

  Frame WithoutDepth() const {
    Frame frame = prev_;
    frame.depth = cv::Mat(frame.depth.size(), CV_16UC1, cv::Scalar(0));
    return frame;
  }
};

TEST_P(EveryFrontendTest, FindsFeaturesAgain) {
  const FeatureMatches found = MatchFrom(prev_, cur_, cur_from_prev_);
  ExpectMostlyRight(found, 100, 1.0, 4.0);
}

// Matches with another frame in between do not matter, nor where images lie.
TEST_P(EveryFrontendTest, TheSameFramesGiveTheSameMatches) {
  const auto reference = Detect(prev_);
  const FeatureMatches once = MatchFrom(*reference, cur_, cur_from_prev_);
  MatchFrom(*reference, dataset_.Read(45), Rigid3d());
  ExpectSame(once, MatchFrom(*reference, cur_.Clone(), cur_from_prev_));
}

TEST_P(EveryFrontendTest, TakesTheNoiseThatItIsGiven) {
  const FeatureMatches stated = MatchFrom(prev_, cur_, cur_from_prev_);
  FrontendOptions options = frontend_->options();
  options.feature_noise = 0.5;
  frontend_ = MakeFrontend(GetParam(), options);
  const FeatureMatches half = MatchFrom(prev_, cur_, cur_from_prev_);
  ASSERT_EQ(half.features, stated.features);
  for (size_t i = 0; i < half.matches.size(); ++i) {
    EXPECT_EQ(half.matches[i].prev.sigma_px,
              0.5 * stated.matches[i].prev.sigma_px);
    EXPECT_EQ(half.matches[i].cur.sigma_px,
              0.5 * stated.matches[i].cur.sigma_px);
  }
}

// The frontend predicts positions with its own camera, not with the camera of
// the matches.
TEST_P(EveryFrontendTest, LooksWhereItsOwnCameraSees) {
  const auto reference = Detect(prev_);
  Camera other = dataset_.camera().camera;
  other.cy += 100.0;
  FeatureMatches found{Correspondences(other), {}};
  const PreparedFrame cur(cur_);
  frontend_->Match(*reference, cur, cur_from_prev_, &found);
  EXPECT_EQ(found.features,
            MatchFrom(*reference, cur, cur_from_prev_).features);
}

TEST_P(EveryFrontendTest, TracksAlongItsAxes) {
  // The noise of a pose is about 2 mm, of patches well below one.
  ExpectTracksAlongItsAxes(GetParam() == "patch" ? 0.003 : 0.01);
}

// Like a camera loop that writes every image to the same memory.
TEST_P(EveryFrontendTest, KeepsNothingOfTheCallersImages) {
  SyntheticOptions options;
  options.path = "pan_tilt";
  options.frames = 60;
  options.camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5, 0, 0, 0};
  static const RenderedOnce camera(options);
  FrontendOptions frontend;
  frontend.camera = camera.camera().camera;
  std::vector<Odometry> odometries;  // one gets new frames, one reused ones
  for (int i = 0; i < 2; ++i) {
    odometries.emplace_back(
        OdometryOptions(),
        std::make_unique<FeatureTracker>(MakeFrontend(GetParam(), frontend),
                                         Estimator({}, MakeRobustCosts())));
  }
  int references = 0;
  Frame reused;
  for (int i = 0; i < 20; ++i) {
    const Frame fresh = camera.Read(i);
    fresh.gray.copyTo(reused.gray);
    fresh.depth.copyTo(reused.depth);
    const TrackedFrame expected = odometries[0].Track(fresh);
    const TrackedFrame tracked = odometries[1].Track(reused);
    EXPECT_EQ(tracked.inliers, expected.inliers) << i;
    EXPECT_EQ(tracked.world_from_cam.translation,
              expected.world_from_cam.translation)
        << i;
    references += tracked.is_reference;
  }
  EXPECT_GE(references, 2) << "the test is vacuous";
}

TEST_P(EveryFrontendTest, FindsNothingInTheDark) {
  EXPECT_TRUE(Detect(Black())->observations.empty());
  EXPECT_EQ(MatchFrom(Black(), prev_, Rigid3d()).matches.size(), 0u);
  EXPECT_EQ(MatchFrom(prev_, Black(), Rigid3d()).matches.size(), 0u);
  EXPECT_EQ(MatchFrom(Black(), Black(), Rigid3d()).matches.size(), 0u);
}

TEST_P(EveryFrontendTest, FindsNothingWithoutDepth) {
  EXPECT_TRUE(Detect(WithoutDepth())->observations.empty());
  EXPECT_EQ(MatchFrom(WithoutDepth(), cur_, Rigid3d()).matches.size(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Frontends, EveryFrontendTest,
                         ::testing::ValuesIn(FrontendNames()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace rgbd_pose
