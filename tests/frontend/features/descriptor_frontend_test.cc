#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "frontend/features/frontend.h"
#include "tests/support/matched_views.h"
#include "tests/support/motions.h"

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
  ExpectMostlyRight(MatchFrom(prev_, cur_, Rigid3d()));
  // Matching the frame with itself returns the same features, to the bit.
  const std::unique_ptr<FeatureSet> reference = Detect(prev_);
  const FeatureMatches itself = MatchFrom(*reference, prev_, Rigid3d());
  ASSERT_GE(itself.matches.size(), 100u);
  for (size_t i = 0; i < itself.matches.size(); ++i) {
    EXPECT_EQ(itself.matches[i].prev.u, itself.matches[i].cur.u);
    EXPECT_EQ(itself.matches[i].prev.depth, itself.matches[i].cur.depth);
  }
}

TEST_P(DescriptorFrontendTest, FeaturesAreSpreadOverTheImage) {
  const std::unique_ptr<FeatureSet> features = Detect(prev_);
  ASSERT_GE(features->observations.size(), 200u);
  int quadrants[2][2] = {};
  for (const Observation& o : features->observations) {
    EXPECT_GT(o.depth, 0.0);
    ++quadrants[o.v > prev_.gray.rows / 2.0][o.u > prev_.gray.cols / 2.0];
  }
  for (const auto& row : quadrants) {
    for (const int count : row) {
      // 40 % of an equal share.
      EXPECT_GE(count, static_cast<int>(features->observations.size()) / 10);
    }
  }
}

TEST_P(DescriptorFrontendTest, CoarserKeypointsAreLessExact) {
  const std::unique_ptr<FeatureSet> features = Detect(prev_);
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

TEST_P(DescriptorFrontendTest, AWrongGuessStillGivesMatches) {
  const Rigid3d turned =
      Moved(0.0, 0.3, 0.0) * Turned(0.5, Eigen::Vector3d::UnitY());
  ExpectMostlyRight(MatchFrom(prev_, cur_, turned));
  const Rigid3d behind = Turned(M_PI, Eigen::Vector3d::UnitY());
  ExpectMostlyRight(MatchFrom(prev_, cur_, behind));
}

INSTANTIATE_TEST_SUITE_P(Methods, DescriptorFrontendTest,
                         ::testing::Values("orb", "sift", "akaze"),
                         [](const auto& info) {
                           return std::string(info.param);
                         });

}  // namespace
}  // namespace rgbd_pose
