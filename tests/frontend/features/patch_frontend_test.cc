#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <vector>

#include "frontend/features/frontend.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "tests/support/matched_views.h"

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

  static void ExpectSame(const FeatureMatches& a, const FeatureMatches& b) {
    ASSERT_EQ(a.features, b.features);
    for (size_t i = 0; i < a.matches.size(); ++i) {
      EXPECT_EQ(a.matches[i].cur.u, b.matches[i].cur.u);
      EXPECT_EQ(a.matches[i].cur.v, b.matches[i].cur.v);
      EXPECT_EQ(a.matches[i].cur.sigma_px, b.matches[i].cur.sigma_px);
    }
  }

  static Rigid3d Turn(double angle, const Eigen::Vector3d& axis) {
    return Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)),
                   Eigen::Vector3d::Zero());
  }

  static Frame WithGray(const Frame& frame, const cv::Mat& gray) {
    Frame other = frame;
    other.gray = gray;
    return other;
  }
};

TEST_F(PatchFrontendTest, MatchesAreWhereTheTruthHasThem) {
  const Frame prev = dataset_.Read(kPrev);
  const Frame cur = dataset_.Read(kCur);
  ExpectMostlyRight(MatchFrom(prev, cur, cur_from_prev_));
}

// Errors as large as those of a start from coarse images, and larger.
TEST_F(PatchFrontendTest, WrongGuessesStillGiveMatches) {
  const Frame prev = dataset_.Read(kPrev);
  const Frame cur = dataset_.Read(kCur);
  const double f = dataset_.camera().camera.fx;
  for (const double px : {2.0, 4.0}) {
    SCOPED_TRACE(px);
    for (const double sign : {-1.0, 1.0}) {
      ExpectMostlyRight(MatchFrom(
          prev, cur,
          Turn(sign * px / f, Eigen::Vector3d::UnitY()) * cur_from_prev_));
      ExpectMostlyRight(MatchFrom(
          prev, cur,
          Turn(sign * px / f, Eigen::Vector3d::UnitX()) * cur_from_prev_));
    }
  }
}

TEST_F(PatchFrontendTest, ExposureDoesNotMatter) {
  const Frame prev = dataset_.Read(kPrev);
  const Frame cur = dataset_.Read(kCur);
  for (const double gain : {0.5, 0.7, 1.4, 2.0}) {
    SCOPED_TRACE(gain);
    cv::Mat gray;
    cur.gray.convertTo(gray, CV_8UC1, gain);
    ExpectMostlyRight(MatchFrom(prev, WithGray(cur, gray), cur_from_prev_));
  }
}

// Matches with other frames in between, which share the patches, do not matter.
TEST_F(PatchFrontendTest, TheSameFramesGiveTheSameMatches) {
  const std::unique_ptr<FeatureSet> reference = Detect(dataset_.Read(kPrev));
  const Frame cur = dataset_.Read(kCur);
  const FeatureMatches once = MatchFrom(*reference, cur, Rigid3d());
  MatchFrom(*reference, dataset_.Read(45), Rigid3d());
  ExpectSame(once, MatchFrom(*reference, cur, Rigid3d()));
}

// Nor do other references, more than the frontend keeps the patches of.
TEST_F(PatchFrontendTest, OtherReferencesDoNotMatter) {
  const Frame cur = dataset_.Read(kCur);
  std::vector<std::unique_ptr<FeatureSet>> references;
  std::vector<FeatureMatches> once;
  for (int i = 0; i < 5; ++i) {
    references.push_back(Detect(dataset_.Read(kPrev + i)));
    once.push_back(MatchFrom(*references[i], cur, cur_from_prev_));
    EXPECT_GT(once[i].matches.size(), 100u);
  }
  for (const int i : {4, 0, 3, 3, 1, 2, 4}) {
    SCOPED_TRACE(i);
    ExpectSame(once[i], MatchFrom(*references[i], cur, cur_from_prev_));
  }
}

TEST_F(PatchFrontendTest, AnotherSceneGivesFewMatches) {
  const Frame prev = dataset_.Read(kPrev);
  cv::Mat turned;
  cv::rotate(prev.gray, turned, cv::ROTATE_180);
  const std::unique_ptr<FeatureSet> reference = Detect(prev);
  const FeatureMatches found =
      MatchFrom(*reference, WithGray(prev, turned), Rigid3d());
  EXPECT_LT(found.matches.size(), reference->observations.size() / 5);
}

TEST_F(PatchFrontendTest, NonsenseGuessesDoNoHarm) {
  const Frame prev = dataset_.Read(kPrev);
  const Frame cur = dataset_.Read(kCur);
  const Rigid3d behind = Turn(M_PI, Eigen::Vector3d::UnitY());
  EXPECT_EQ(MatchFrom(prev, cur, behind).matches.size(), 0u);
  const Rigid3d far(Eigen::Quaterniond::Identity(), {1e6, 0.0, 0.0});
  EXPECT_EQ(MatchFrom(prev, cur, far).matches.size(), 0u);
}

TEST_F(PatchFrontendTest, SmallAndOddImagesAreTaken) {
  const Frame full = dataset_.Read(kPrev);
  for (const cv::Size& size : {cv::Size(101, 67), cv::Size(24, 24)}) {
    Frame small = full;
    small.gray = full.gray(cv::Rect(cv::Point(200, 200), size)).clone();
    small.depth = full.depth(cv::Rect(cv::Point(200, 200), size)).clone();
    const FeatureMatches found = MatchFrom(small, small, Rigid3d());
    for (size_t i = 0; i < found.matches.size(); ++i) {
      EXPECT_NEAR(found.matches[i].prev.u, found.matches[i].cur.u, 0.01);
    }
  }
}

TEST_F(PatchFrontendTest, LessCertainMatchesSaySo) {
  const FeatureMatches found =
      MatchFrom(dataset_.Read(kPrev), dataset_.Read(kCur), cur_from_prev_);
  double least = 1e9;
  double most = 0.0;
  for (size_t i = 0; i < found.matches.size(); ++i) {
    least = std::min(least, found.matches[i].cur.sigma_px);
    most = std::max(most, found.matches[i].cur.sigma_px);
  }
  EXPECT_GE(least, 0.3);
  EXPECT_GE(most, 1.5 * least);
}

TEST_F(PatchFrontendTest, TracksAlongItsAxes) {
  // Several times the noise of a pose, which is well below a millimetre.
  ExpectTracksAlongItsAxes(0.003);
}

}  // namespace
}  // namespace rgbd_pose
