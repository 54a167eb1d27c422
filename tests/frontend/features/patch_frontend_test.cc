#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "frontend/features/frontend.h"
#include "tests/support/matched_views.h"
#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

// Depth noise moves a point by up to half a pixel at this baseline.
constexpr double kPatchMedianPx = 0.5;

// A match with a larger error is an outlier.
constexpr double kPatchWrongPx = 3.0;

class PatchFrontendTest : public ::testing::Test, protected MatchedViews {
 protected:
  PatchFrontendTest() : MatchedViews("patch") {}

  void ExpectMostlyRight(const FeatureMatches& found) const {
    MatchedViews::ExpectMostlyRight(found, 200, kPatchMedianPx, kPatchWrongPx);
  }

  static Frame WithGray(const Frame& frame, const cv::Mat& gray) {
    Frame other = frame;
    other.gray = gray;
    return other;
  }
};

// Errors as large as those of a start from coarse images, and larger.
TEST_F(PatchFrontendTest, MatchesAreRightWithWrongGuessesToo) {
  ExpectMostlyRight(MatchFrom(prev_, cur_, cur_from_prev_));
  const double f = dataset_.camera().camera.fx;
  for (const double px : {-4.0, -2.0, 2.0, 4.0}) {
    SCOPED_TRACE(px);
    for (const int axis : {0, 1}) {
      const Rigid3d off = Turned(px / f, Eigen::Vector3d::Unit(axis));
      ExpectMostlyRight(MatchFrom(prev_, cur_, off * cur_from_prev_));
    }
  }
}

TEST_F(PatchFrontendTest, ExposureDoesNotMatter) {
  for (const double gain : {0.5, 0.7, 1.4, 2.0}) {
    SCOPED_TRACE(gain);
    cv::Mat gray;
    cur_.gray.convertTo(gray, CV_8UC1, gain);
    ExpectMostlyRight(MatchFrom(prev_, WithGray(cur_, gray), cur_from_prev_));
  }
}

// More than the frontend keeps the patches of.
TEST_F(PatchFrontendTest, OtherReferencesDoNotMatter) {
  std::vector<std::unique_ptr<FeatureSet>> references;
  std::vector<FeatureMatches> once;
  for (int i = 0; i < 5; ++i) {
    references.push_back(Detect(dataset_.Read(kPrev + i)));
    once.push_back(MatchFrom(*references[i], cur_, cur_from_prev_));
    EXPECT_GT(once[i].matches.size(), 100u);
  }
  for (const int i : {4, 0, 3, 3, 1, 2, 4}) {
    SCOPED_TRACE(i);
    ExpectSame(once[i], MatchFrom(*references[i], cur_, cur_from_prev_));
  }
}

TEST_F(PatchFrontendTest, AnotherSceneGivesFewMatches) {
  cv::Mat turned;
  cv::rotate(prev_.gray, turned, cv::ROTATE_180);
  const std::unique_ptr<FeatureSet> reference = Detect(prev_);
  const FeatureMatches found =
      MatchFrom(*reference, WithGray(prev_, turned), Rigid3d());
  EXPECT_LT(found.matches.size(), reference->observations.size() / 5);
}

TEST_F(PatchFrontendTest, NonsenseGuessesDoNoHarm) {
  const Rigid3d behind = Turned(M_PI, Eigen::Vector3d::UnitY());
  EXPECT_EQ(MatchFrom(prev_, cur_, behind).matches.size(), 0u);
  EXPECT_EQ(MatchFrom(prev_, cur_, Moved(1e6, 0.0, 0.0)).matches.size(), 0u);
}

TEST_F(PatchFrontendTest, SmallAndOddImagesAreTaken) {
  for (const cv::Size& size : {cv::Size(101, 67), cv::Size(24, 24)}) {
    Frame small = prev_;
    small.gray = prev_.gray(cv::Rect(cv::Point(200, 200), size)).clone();
    small.depth = prev_.depth(cv::Rect(cv::Point(200, 200), size)).clone();
    const FeatureMatches found = MatchFrom(small, small, Rigid3d());
    for (size_t i = 0; i < found.matches.size(); ++i) {
      EXPECT_NEAR(found.matches[i].prev.u, found.matches[i].cur.u, 0.01);
    }
  }
}

TEST_F(PatchFrontendTest, LessCertainMatchesSaySo) {
  const FeatureMatches found = MatchFrom(prev_, cur_, cur_from_prev_);
  double least = 1e9;
  double most = 0.0;
  for (size_t i = 0; i < found.matches.size(); ++i) {
    least = std::min(least, found.matches[i].cur.sigma_px);
    most = std::max(most, found.matches[i].cur.sigma_px);
  }
  EXPECT_GE(least, 0.3);
  EXPECT_GE(most, 1.5 * least);
}

}  // namespace
}  // namespace rgbd_pose
