#include "frontend/tracking/feature_validation.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

const Camera kKinect = {640, 480, 525, 525, 319.5, 239.5, 0, 0, 0};
constexpr double kDepth = 2.0;

Observation At(double u, double v) { return {u, v, kDepth, 0.5, 0.01}; }

// Features of a static camera: those in the left half agree, those in the right
// half do not or are not found.
class FeatureValidationTest : public testing::Test {
 protected:
  FeatureValidationTest() {
    for (int v = 40; v < 480; v += 20) {
      for (int u = 40; u < 640; u += 20) {
        const int i = static_cast<int>(last_.observations.size());
        last_.observations.push_back(At(u, v));
        const bool left = u < 320;
        const bool is_found = left || i % 2 == 0;
        if (is_found) AddFound(i, At(left ? u : u + 15, v), left);
      }
    }
    fresh_.observations = {At(100, 100), At(200, 300), At(500, 100),
                           At(550, 300)};
  }

  // Adds a match of a feature of the last reference.
  void AddFound(int feature, const Observation& found, bool is_inlier) {
    found_.Add(last_, feature, found);
    estimate_.is_inlier.push_back(is_inlier);
    estimate_.residual_degrees.push_back(3);
  }
  void ForgetFound() {
    found_.Clear();
    estimate_.is_inlier.clear();
    estimate_.residual_degrees.clear();
  }
  // Finds those in the left half where they were.
  void FindLeftHalf() {
    for (size_t i = 0; i < last_.observations.size(); ++i) {
      const Observation& o = last_.observations[i];
      if (o.u < 320) AddFound(static_cast<int>(i), o, true);
    }
  }
  // No cost could use the matches that do not agree.
  void LeaveOutliersUnused() {
    for (size_t i = 0; i < estimate_.is_inlier.size(); ++i) {
      if (!estimate_.is_inlier[i]) estimate_.residual_degrees[i] = 0;
    }
  }

  FeatureValidation Validation(bool missing_failed,
                               size_t min_trusted = 1) const {
    return FeatureValidation(last_, tracked_, missing_failed, fresh_,
                             min_trusted);
  }

  // Splits matches of all fresh features; returns those on probation.
  std::vector<int> OnProbation(const FeatureValidation& validation) const {
    FeatureMatches all{Correspondences(kKinect), {}};
    FeatureMatches on_probation = all;
    for (int i = 0; i < 4; ++i) all.Add(fresh_, i, fresh_.observations[i]);
    validation.Split(&all, &on_probation);
    EXPECT_EQ(all.features.size() + on_probation.features.size(), 4u);
    EXPECT_EQ(all.matches.size(), all.features.size());
    EXPECT_EQ(on_probation.matches.size(), on_probation.features.size());
    return on_probation.features;
  }

  FeatureSet last_, fresh_;
  TrackingResult tracked_{kKinect};
  FeatureMatches& found_ = tracked_.matches;
  FeatureMatches& on_probation_ = tracked_.on_probation;
  MotionEstimate& estimate_ = tracked_.estimate;
};

TEST_F(FeatureValidationTest, FeaturesWhereOthersFailedAreOnProbation) {
  for (const bool missing_failed : {true, false}) {
    const FeatureValidation validation = Validation(missing_failed);
    EXPECT_EQ(validation.num_trusted(), 2u);
    EXPECT_EQ(OnProbation(validation), (std::vector<int>{2, 3}));
  }
}

// For example without depth in the current frame.
TEST_F(FeatureValidationTest, MatchesThatNoCostCouldUseTellNothing) {
  LeaveOutliersUnused();
  EXPECT_EQ(Validation(/*missing_failed=*/false).num_trusted(), 4u);
}

TEST_F(FeatureValidationTest, WhatWasNotFoundCountsOnlyIfAsked) {
  ForgetFound();
  EXPECT_EQ(Validation(/*missing_failed=*/true).num_trusted(), 0u + 4u)
      << "all would be on probation, so none are";
  EXPECT_EQ(Validation(/*missing_failed=*/false).num_trusted(), 4u);
  FindLeftHalf();
  EXPECT_EQ(Validation(/*missing_failed=*/true).num_trusted(), 2u);
  EXPECT_EQ(Validation(/*missing_failed=*/false).num_trusted(), 4u);
}

// Features on probation at the last reference that now agree validate the
// features around them. Other features on probation do not.
TEST_F(FeatureValidationTest, FeaturesOnProbationThatAgreeSpeakForTheirPlace) {
  ForgetFound();
  FindLeftHalf();
  for (size_t i = 0; i < last_.observations.size(); ++i) {
    const Observation& o = last_.observations[i];
    if (o.u < 320) continue;
    on_probation_.Add(last_, static_cast<int>(i),
                      At(o.v < 240 ? o.u : o.u + 15, o.v));
  }
  EXPECT_EQ(OnProbation(Validation(/*missing_failed=*/true)),
            (std::vector<int>{3}));
}

// Matches of another reference are an error of the caller, which must not cause
// writes beyond the features.
TEST_F(FeatureValidationTest, MatchesOfAnotherReferenceAreRefused) {
  FeatureSet larger = last_;
  larger.observations.push_back(At(100, 100));
  on_probation_.Add(larger, static_cast<int>(last_.observations.size()),
                    At(100, 100));
  EXPECT_THROW(Validation(/*missing_failed=*/true), std::out_of_range);
}

TEST_F(FeatureValidationTest, AllAreTrustedIfTooFewWouldBeLeft) {
  EXPECT_EQ(Validation(true, 2).num_trusted(), 2u);
  EXPECT_EQ(Validation(true, 3).num_trusted(), 4u);
}

TEST_F(FeatureValidationTest, TrustIsEarnedByAgreeingSomeTimesInARow) {
  FeatureValidation validation = Validation(true);
  FeatureMatches agreeing{Correspondences(kKinect), {}};
  agreeing.Add(fresh_, 2, At(501, 100));
  FeatureMatches off = agreeing;
  off.Clear();
  off.Add(fresh_, 2, At(505, 100));
  validation.Learn(agreeing, Rigid3d());
  validation.Learn(agreeing, Rigid3d());
  validation.Learn(off, Rigid3d());  // restarts the count
  validation.Learn(agreeing, Rigid3d());
  validation.Learn(agreeing, Rigid3d());
  EXPECT_EQ(OnProbation(validation), (std::vector<int>{2, 3}));
  validation.Learn(agreeing, Rigid3d());
  EXPECT_EQ(OnProbation(validation), (std::vector<int>{3}));
}

// After another motion was chosen, features may be on probation that are
// trusted.
TEST_F(FeatureValidationTest, AgreementDoesNotTakeTrustAway) {
  FeatureValidation validation = Validation(true);
  FeatureMatches agreeing{Correspondences(kKinect), {}};
  agreeing.Add(fresh_, 0, fresh_.observations[0]);
  for (int i = 0; i < 2; ++i) validation.Learn(agreeing, Rigid3d());
  EXPECT_EQ(OnProbation(validation), (std::vector<int>{2, 3}));
}

// With a lens that compresses the border, ideal pixels lie beyond the image.
TEST_F(FeatureValidationTest, FailuresOutsideTheImageSayNothing) {
  for (int k = 0; k < 3; ++k) {
    const int i = static_cast<int>(last_.observations.size());
    last_.observations.push_back(At(700 + 20 * k, 100));
    AddFound(i, At(720 + 20 * k, 100), false);
  }
  fresh_.observations.push_back(At(-80, 300));
  EXPECT_EQ(Validation(/*missing_failed=*/true).num_trusted(), 3u);
}

TEST_F(FeatureValidationTest, AgreementIsWithTheMotion) {
  FeatureValidation validation = Validation(true);
  // 2 cm to the left at 2 m: 5.25 px.
  FeatureMatches moved{Correspondences(kKinect), {}};
  moved.Add(fresh_, 3, At(550 - 5.25, 300));
  for (int i = 0; i < 3; ++i) validation.Learn(moved, Moved(-0.02, 0.0, 0.0));
  EXPECT_EQ(OnProbation(validation), (std::vector<int>{2}));
}

class MovingRegionsTest : public FeatureValidationTest {
 protected:
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
  ForgetFound();
  FindLeftHalf();  // nothing in the right half
  EXPECT_NEAR(MarkMoving(last_, true, &tracked_), 0.55, 0.07);
  EXPECT_FALSE(moving_.Contains(100, 200));
  EXPECT_TRUE(moving_.Contains(500, 200));
  EXPECT_EQ(MarkMoving(last_, false, &tracked_), 1.0);
  EXPECT_FALSE(moving_.Contains(500, 200)) << "a frontend that finds some only";
}

TEST_F(MovingRegionsTest, MatchesThatNoCostCouldUseTellNothing) {
  LeaveOutliersUnused();
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
  Camera barrel = kKinect;
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
