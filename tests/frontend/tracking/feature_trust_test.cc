#include "frontend/tracking/feature_trust.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace rgbd_pose {
namespace {

const Camera kKinect = {640, 480, 525, 525, 319.5, 239.5, 0, 0, 0};
constexpr double kDepth = 2.0;

Observation At(double u, double v) { return {u, v, kDepth, 0.5, 0.01}; }

// Features of a camera that does not move: those in the left half agree, those
// in the right half do not or are not found.
class FeatureTrustTest : public testing::Test {
 protected:
  FeatureTrustTest() : found_{Correspondences(kKinect), {}}, doubted_(found_) {
    for (int v = 40; v < 480; v += 20) {
      for (int u = 40; u < 640; u += 20) {
        const int i = static_cast<int>(last_.observations.size());
        last_.observations.push_back(At(u, v));
        const bool left = u < 320;
        const bool is_found = left || i % 2 == 0;
        if (is_found) {
          found_.Add(last_, i, At(left ? u : u + 15, v));
          estimate_.is_inlier.push_back(left);
        }
      }
    }
    fresh_.observations = {At(100, 100), At(200, 300), At(500, 100),
                           At(550, 300)};
  }

  FeatureTrust Trust(bool missing_failed, size_t min_trusted = 1) const {
    return FeatureTrust(last_, found_, doubted_, estimate_, missing_failed,
                        fresh_, min_trusted);
  }

  // Splits matches of all fresh features; those of the doubted ones.
  std::vector<int> Doubted(const FeatureTrust& trust) const {
    FeatureMatches all{Correspondences(kKinect), {}};
    FeatureMatches doubted = all;
    for (int i = 0; i < 4; ++i) all.Add(fresh_, i, fresh_.observations[i]);
    trust.Split(&all, &doubted);
    EXPECT_EQ(all.features.size() + doubted.features.size(), 4u);
    EXPECT_EQ(all.matches.size(), all.features.size());
    EXPECT_EQ(doubted.matches.size(), doubted.features.size());
    return doubted.features;
  }

  FeatureSet last_, fresh_;
  FeatureMatches found_, doubted_;
  MotionEstimate estimate_;
};

TEST_F(FeatureTrustTest, FeaturesWhereOthersFailedAreDoubted) {
  for (const bool missing_failed : {true, false}) {
    const FeatureTrust trust = Trust(missing_failed);
    EXPECT_EQ(trust.num_trusted(), 2u);
    EXPECT_EQ(Doubted(trust), (std::vector<int>{2, 3}));
  }
}

TEST_F(FeatureTrustTest, WhatWasNotFoundCountsOnlyIfAsked) {
  found_.Clear();
  estimate_.is_inlier.clear();
  EXPECT_EQ(Trust(/*missing_failed=*/true).num_trusted(), 0u + 4u)
      << "all would be doubted, so none are";
  EXPECT_EQ(Trust(/*missing_failed=*/false).num_trusted(), 4u);
  for (int i = 0; i < static_cast<int>(last_.observations.size()); ++i) {
    if (last_.observations[i].u < 320) {
      found_.Add(last_, i, last_.observations[i]);
      estimate_.is_inlier.push_back(true);
    }
  }
  EXPECT_EQ(Trust(/*missing_failed=*/true).num_trusted(), 2u);
  EXPECT_EQ(Trust(/*missing_failed=*/false).num_trusted(), 4u);
}

// Features of the last reference that were doubted, but agree by now, speak for
// those around them; others that were doubted do not.
TEST_F(FeatureTrustTest, DoubtedFeaturesThatAgreeSpeakForTheirPlace) {
  FeatureMatches left{Correspondences(kKinect), {}};
  estimate_.is_inlier.clear();
  for (int i = 0; i < static_cast<int>(last_.observations.size()); ++i) {
    const Observation o = last_.observations[i];
    if (o.u < 320) {
      left.Add(last_, i, o);
      estimate_.is_inlier.push_back(true);
    } else {
      doubted_.Add(last_, i, At(o.v < 240 ? o.u : o.u + 15, o.v));
    }
  }
  found_ = left;
  EXPECT_EQ(Doubted(Trust(/*missing_failed=*/true)), (std::vector<int>{3}));
}

// Matches of another reference are a mistake of the caller's: it must not write
// beyond the features there are.
TEST_F(FeatureTrustTest, MatchesOfAnotherReferenceAreRefused) {
  FeatureSet larger = last_;
  larger.observations.push_back(At(100, 100));
  doubted_.Add(larger, static_cast<int>(last_.observations.size()),
               At(100, 100));
  EXPECT_THROW(Trust(/*missing_failed=*/true), std::out_of_range);
}

TEST_F(FeatureTrustTest, AllAreTrustedIfTooFewWouldBeLeft) {
  EXPECT_EQ(Trust(true, 2).num_trusted(), 2u);
  EXPECT_EQ(Trust(true, 3).num_trusted(), 4u);
}

TEST_F(FeatureTrustTest, TrustIsEarnedByAgreeingSomeTimesInARow) {
  FeatureTrust trust = Trust(true);
  FeatureMatches agreeing{Correspondences(kKinect), {}};
  agreeing.Add(fresh_, 2, At(501, 100));
  FeatureMatches off = agreeing;
  off.Clear();
  off.Add(fresh_, 2, At(505, 100));
  trust.Learn(agreeing, Rigid3d());
  trust.Learn(agreeing, Rigid3d());
  trust.Learn(off, Rigid3d());  // starts anew
  trust.Learn(agreeing, Rigid3d());
  trust.Learn(agreeing, Rigid3d());
  EXPECT_EQ(Doubted(trust), (std::vector<int>{2, 3}));
  trust.Learn(agreeing, Rigid3d());
  EXPECT_EQ(Doubted(trust), (std::vector<int>{3}));
}

TEST_F(FeatureTrustTest, AgreementIsWithTheMotion) {
  FeatureTrust trust = Trust(true);
  // 2 cm to the left of 2 m: 5.25 px.
  const Rigid3d cur_from_ref(Eigen::Quaterniond::Identity(), {-0.02, 0.0, 0.0});
  FeatureMatches moved{Correspondences(kKinect), {}};
  moved.Add(fresh_, 3, At(550 - 5.25, 300));
  for (int i = 0; i < 3; ++i) trust.Learn(moved, cur_from_ref);
  EXPECT_EQ(Doubted(trust), (std::vector<int>{2}));
}

}  // namespace
}  // namespace rgbd_pose
