#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "frontend/features/frontend.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "tests/support/matched_views.h"

namespace rgbd_pose {
namespace {

constexpr double kMedianPx = 1.0;

// A match with a larger error is an outlier: five times the noise of the
// coarsest keypoints.
constexpr double kWrongPx = 8.0;

class DescriptorFrontendTest : public ::testing::TestWithParam<const char*>,
                               protected MatchedViews {
 protected:
  DescriptorFrontendTest() : MatchedViews(GetParam()) {}

  // Enough for a good pose: more than twice the odometry's limit for ok.
  void ExpectMostlyRight(const FeatureMatches& found) const {
    MatchedViews::ExpectMostlyRight(found, 100, kMedianPx, kWrongPx);
  }
};

TEST_P(DescriptorFrontendTest, MatchesAreWhereTheTruthHasThem) {
  const Frame prev = dataset_.Read(kPrev);
  const Frame cur = dataset_.Read(kCur);
  const FeatureMatches found = MatchFrom(prev, cur, Rigid3d());
  ExpectMostlyRight(found);
  EXPECT_EQ(found.features.size(), found.matches.size());
  // Matching the frame with itself returns the same features, to the bit.
  const std::unique_ptr<FeatureSet> reference = Detect(prev);
  const FeatureMatches itself = MatchFrom(*reference, prev, Rigid3d());
  ASSERT_GE(itself.matches.size(), 100u);
  for (size_t i = 0; i < itself.matches.size(); ++i) {
    EXPECT_EQ(itself.matches[i].prev.u, itself.matches[i].cur.u);
    EXPECT_EQ(itself.matches[i].prev.depth, itself.matches[i].cur.depth);
  }
}

TEST_P(DescriptorFrontendTest, FeaturesAreSpreadOverTheImage) {
  const Frame frame = dataset_.Read(kPrev);
  const std::unique_ptr<FeatureSet> features = Detect(frame);
  ASSERT_GE(features->observations.size(), 200u);
  int quadrants[2][2] = {};
  for (const Observation& o : features->observations) {
    EXPECT_GT(o.depth, 0.0);
    ++quadrants[o.v > frame.gray.rows / 2.0][o.u > frame.gray.cols / 2.0];
  }
  for (const auto& row : quadrants) {
    for (const int count : row) {
      // 40 % of an equal share.
      EXPECT_GE(count, static_cast<int>(features->observations.size()) / 10);
    }
  }
}

TEST_P(DescriptorFrontendTest, CoarserKeypointsAreLessExact) {
  const std::unique_ptr<FeatureSet> features = Detect(dataset_.Read(kPrev));
  double least = 1e9;
  double most = 0.0;
  for (const Observation& o : features->observations) {
    least = std::min(least, o.sigma_px);
    most = std::max(most, o.sigma_px);
  }
  EXPECT_GE(least, 0.2);
  EXPECT_LE(least, 1.0);
  EXPECT_GE(most, 2.0 * least);
}

TEST_P(DescriptorFrontendTest, TheSameFramesGiveTheSameMatches) {
  const Frame prev = dataset_.Read(kPrev);
  const Frame cur = dataset_.Read(kCur);
  const FeatureMatches once = MatchFrom(prev, cur, Rigid3d());
  // A copy has no precomputed data.
  Frame copy = cur;
  copy.gray = cur.gray.clone();
  const FeatureMatches twice = MatchFrom(prev, copy, Rigid3d());
  ASSERT_EQ(once.features, twice.features);
  for (size_t i = 0; i < once.matches.size(); ++i) {
    EXPECT_EQ(once.matches[i].cur.u, twice.matches[i].cur.u);
    EXPECT_EQ(once.matches[i].cur.v, twice.matches[i].cur.v);
  }
}

TEST_P(DescriptorFrontendTest, AWrongGuessStillGivesMatches) {
  const Frame prev = dataset_.Read(kPrev);
  const Frame cur = dataset_.Read(kCur);
  const Rigid3d turned(
      Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY())),
      Eigen::Vector3d(0.0, 0.3, 0.0));
  ExpectMostlyRight(MatchFrom(prev, cur, turned));
  const Rigid3d behind(
      Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY())),
      Eigen::Vector3d::Zero());
  ExpectMostlyRight(MatchFrom(prev, cur, behind));
}

INSTANTIATE_TEST_SUITE_P(Methods, DescriptorFrontendTest,
                         ::testing::Values("orb", "sift", "akaze"),
                         [](const auto& info) {
                           return std::string(info.param);
                         });

}  // namespace
}  // namespace rgbd_pose
