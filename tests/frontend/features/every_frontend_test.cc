// What is asked of every frontend, whatever it finds features by. A new one
// joins by its row in frontend/features/frontend.cc.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>

#include "frontend/features/frontend.h"
#include "tests/support/matched_views.h"

namespace rgbd_pose {
namespace {

class EveryFrontendTest : public MatchedViews,
                          public ::testing::TestWithParam<std::string> {
 protected:
  EveryFrontendTest() : MatchedViews(GetParam()) {}

  Frame Black() const {
    Frame frame = dataset_.Read(kCur);
    frame.gray = cv::Mat(frame.gray.size(), CV_8UC1, cv::Scalar(0));
    return frame;
  }
};

TEST_P(EveryFrontendTest, FindsFeaturesAgain) {
  const FeatureMatches found =
      MatchFrom(dataset_.Read(kPrev), dataset_.Read(kCur), cur_from_prev_);
  ExpectMostlyRight(found, 100, 1.0, 4.0);
}

TEST_P(EveryFrontendTest, TracksAlongItsAxes) {
  ExpectTracksAlongItsAxes(0.01);  // the noise of a pose is about 2 mm
}

TEST_P(EveryFrontendTest, GivesTheSameWhetherFramesArePreparedOrNot) {
  const Frame prev = dataset_.Read(kPrev);
  Frame cur = dataset_.Read(kCur);
  const FeatureMatches plain = MatchFrom(prev, cur, cur_from_prev_);
  frontend_->Prepare(&cur);
  const FeatureMatches prepared = MatchFrom(prev, cur, cur_from_prev_);
  ASSERT_EQ(plain.features, prepared.features);
  for (size_t i = 0; i < plain.matches.size(); ++i) {
    EXPECT_EQ(plain.matches[i].cur.u, prepared.matches[i].cur.u);
    EXPECT_EQ(plain.matches[i].cur.depth, prepared.matches[i].cur.depth);
  }
}

TEST_P(EveryFrontendTest, FindsNothingInTheDark) {
  const Frame lit = dataset_.Read(kPrev);
  EXPECT_TRUE(frontend_->Detect(Black())->observations.empty());
  EXPECT_EQ(MatchFrom(Black(), lit, Rigid3d()).matches.size(), 0u);
  EXPECT_EQ(MatchFrom(lit, Black(), Rigid3d()).matches.size(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Frontends, EveryFrontendTest,
                         ::testing::ValuesIn(FrontendNames()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace rgbd_pose
