#include <gtest/gtest.h>

#include "frontend/tracking/feature_validation.h"

namespace rgbd_pose {
namespace {

const Camera kPinhole = {640, 480, 525, 525, 319.5, 239.5, 0, 0, 0};

// Features of a static camera: those in the left half agree, those in the right
// half do not or are not found.
class MovingRegionsTest : public testing::Test {
 protected:
  MovingRegionsTest() {
    for (int v = 40; v < 480; v += 20) {
      for (int u = 40; u < 640; u += 20) {
        const int i = static_cast<int>(last_.observations.size());
        last_.observations.push_back({1.0 * u, 1.0 * v, 2.0, 0.5, 0.01});
        const bool left = u < 320;
        if (!left && i % 2 != 0) continue;
        found_.Add(last_, i, {left ? u : u + 15.0, 1.0 * v, 2.0, 0.5, 0.01});
        estimate_.is_inlier.push_back(left);
        estimate_.residual_degrees.push_back(3);
      }
    }
  }

  FeatureSet last_;
  TrackingResult tracked_{kPinhole};
  FeatureMatches& found_ = tracked_.matches;
  MotionEstimate& estimate_ = tracked_.estimate;
  const CellMask& moving_ = tracked_.moving;
};

TEST_F(MovingRegionsTest, WhereFeaturesContradictTheMotionSomethingMoves) {
  for (const bool missing_contradict : {true, false}) {
    EXPECT_NEAR(MarkMoving(last_, missing_contradict, &tracked_), 0.55, 0.07);
    EXPECT_FALSE(moving_.Contains(100, 200));
    EXPECT_TRUE(moving_.Contains(500, 200));
  }
  EXPECT_FALSE(moving_.Contains(639, 2000)) << "outside";
}

TEST_F(MovingRegionsTest, MissingFeaturesAloneAreHiddenBySomething) {
  // Nothing is found in the right half.
  found_.Clear();
  estimate_.is_inlier.clear();
  estimate_.residual_degrees.clear();
  for (size_t i = 0; i < last_.observations.size(); ++i) {
    const Observation& o = last_.observations[i];
    if (o.u >= 320) continue;
    found_.Add(last_, i, o);
    estimate_.is_inlier.push_back(true);
    estimate_.residual_degrees.push_back(3);
  }
  EXPECT_NEAR(MarkMoving(last_, true, &tracked_), 0.55, 0.07);
  EXPECT_FALSE(moving_.Contains(100, 200));
  EXPECT_TRUE(moving_.Contains(500, 200));
  EXPECT_EQ(MarkMoving(last_, false, &tracked_), 1.0);
  EXPECT_FALSE(moving_.Contains(500, 200)) << "a frontend that finds some only";
}

TEST_F(MovingRegionsTest, MatchesThatNoCostCouldUseTellNothing) {
  for (size_t i = 0; i < estimate_.is_inlier.size(); ++i) {
    if (!estimate_.is_inlier[i]) estimate_.residual_degrees[i] = 0;
  }
  EXPECT_EQ(MarkMoving(last_, false, &tracked_), 1.0);
  EXPECT_FALSE(moving_.Contains(500, 200));
}

TEST_F(MovingRegionsTest, InliersCoverTheirPartOfTheImage) {
  const int left = CellsOfInliers(tracked_);
  EXPECT_NEAR(left, 5 * 8, 8);
  estimate_.is_inlier.assign(estimate_.is_inlier.size(), true);
  EXPECT_NEAR(CellsOfInliers(tracked_), 2 * left, 8);
}

// A barrel lens draws the image's sides inwards. Regions must be marked at the
// distorted pixels, not where a pinhole would see them.
TEST_F(MovingRegionsTest, AreWhereTheLensSeesThem) {
  Camera barrel = kPinhole;
  barrel.k1 = -0.5;
  TrackingResult seen(barrel);
  for (size_t i = 0; i < found_.features.size(); ++i) {
    seen.matches.AddFrom(found_, i);
  }
  seen.on_probation = seen.matches;
  seen.estimate = estimate_;
  MarkMoving(last_, false, &seen);
  EXPECT_TRUE(seen.moving.Contains(500, 240));
  EXPECT_FALSE(seen.moving.Contains(630, 240)) << "beyond what was seen";
  tracked_.on_probation = found_;
  MarkMoving(last_, false, &tracked_);
  EXPECT_TRUE(moving_.Contains(630, 240)) << "of a pinhole";
}

}  // namespace
}  // namespace rgbd_pose
