// Features of a rolling shutter whose velocity becomes known later.

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "frontend/features/frontend.h"
#include "tests/support/rolling_frame.h"

namespace rgbd_pose {
namespace {

constexpr int kIndex = 30;
constexpr double kRounding = 1e-9;

class ObserveAgainTest : public ::testing::TestWithParam<std::string> {
 protected:
  ObserveAgainTest() {
    FrontendOptions options;
    options.camera = HandheldOptions().camera.camera;
    options.feature_noise = 0.5;
    frontend_ = MakeFrontend(GetParam(), options);
  }

  PreparedFrame FrameWith(const std::optional<Twist>& twist) const {
    return frame_.WithTwist(twist);
  }

  // Features detected with one velocity and observed again with the right one.
  std::unique_ptr<FeatureSet> Again(const std::optional<Twist>& first,
                                    const Rigid3d& reference_from_stamp) {
    auto features = frontend_->Detect(FrameWith(first));
    frontend_->ObserveAgain(frame_, reference_from_stamp, features.get());
    return features;
  }

  using Places = std::map<std::pair<float, float>, Observation>;
  static Places PlacesOf(const FeatureSet& features) {
    EXPECT_EQ(features.points.size(), features.observations.size());
    Places places;
    for (size_t i = 0; i < features.points.size(); ++i) {
      const cv::Point2f& point = features.points[i];
      places[{point.x, point.y}] = features.observations[i];
    }
    return places;
  }

  PreparedFrame frame_{RollingFrame(kIndex)};
  std::unique_ptr<Frontend> frontend_;
};

// Nearly all: without a depth, a frontend may leave a feature out at once.
TEST_P(ObserveAgainTest, GivesWhatIsDetectedWithThisVelocity) {
  const Places expected = PlacesOf(*frontend_->Detect(frame_));
  ASSERT_GT(expected.size(), 100u);
  for (const std::optional<Twist>& first :
       {std::optional<Twist>(), std::optional(-1.0 * *frame_.twist)}) {
    size_t found = 0, moved = 0;
    const Places stale = PlacesOf(*frontend_->Detect(FrameWith(first)));
    for (const auto& [point, o] : PlacesOf(*Again(first, Rigid3d()))) {
      const auto at = expected.find(point);
      if (at == expected.end()) continue;
      ++found;
      EXPECT_NEAR(o.u, at->second.u, kRounding);
      EXPECT_NEAR(o.v, at->second.v, kRounding);
      EXPECT_NEAR(o.depth, at->second.depth, kRounding);
      EXPECT_EQ(o.sigma_px, at->second.sigma_px);
      EXPECT_EQ(o.sigma_depth, at->second.sigma_depth);
      EXPECT_LT((o.normal - at->second.normal).norm(), kRounding);
      const Observation& before = stale.at(point);
      moved += std::hypot(o.u - before.u, o.v - before.v) > 1.0;
    }
    EXPECT_GT(found, 0.95 * static_cast<double>(expected.size()));
    EXPECT_GT(moved, 0.5 * static_cast<double>(found)) << "nothing to undo";
  }
}

TEST_P(ObserveAgainTest, MovesPointsAndNormalsToTheAxesOfTheReference) {
  const Camera& camera = frontend_->options().camera;
  const Rigid3d moved =
      Rigid3d::FromRotationVector({0.01, -0.02, 0.015}, {0.02, 0.01, -0.03});
  const auto here = Again(frame_.twist, Rigid3d());
  const auto there = Again(frame_.twist, moved);
  int with_normal = 0;
  for (size_t i = 0; i < here->observations.size(); ++i) {
    const Observation& o = here->observations[i];
    const Observation& seen = there->observations[i];
    if (o.depth == 0.0) continue;
    const Eigen::Vector3d expected = moved * (camera.Ray(o.u, o.v) * o.depth);
    EXPECT_LT((camera.Ray(seen.u, seen.v) * seen.depth - expected).norm(),
              1e-12);
    EXPECT_LT((seen.normal - moved.rotation * o.normal).norm(), 1e-12);
    EXPECT_EQ(seen.sigma_px, o.sigma_px);
    with_normal += !o.normal.isZero(0.0);
  }
  EXPECT_GT(with_normal, 50);
}

// A place whose depth is not known with the better velocity is not given up.
TEST_P(ObserveAgainTest, WhatHasNoDepthForAWhileComesBack) {
  const auto expected = frontend_->Detect(frame_);
  const auto features = frontend_->Detect(frame_);
  Frame blind = frame_;
  blind.depth = cv::Mat(frame_.depth.size(), CV_16UC1, cv::Scalar(0));
  frontend_->ObserveAgain(blind, Rigid3d(), features.get());
  ASSERT_EQ(features->observations.size(), expected->observations.size());
  for (const Observation& o : features->observations) EXPECT_EQ(o.depth, 0.0);
  frontend_->ObserveAgain(frame_, Rigid3d(), features.get());
  for (size_t i = 0; i < features->observations.size(); ++i) {
    EXPECT_NEAR(features->observations[i].depth,
                expected->observations[i].depth, kRounding);
  }
}

INSTANTIATE_TEST_SUITE_P(Frontends, ObserveAgainTest,
                         ::testing::ValuesIn(FrontendNames()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace rgbd_pose
