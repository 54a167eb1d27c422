// User-defined frontends that only follow points.

#include "frontend/features/point_frontend.h"

#include <gtest/gtest.h>

#include "core/util/input_error.h"
#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

// Finds points with and without depth and returns each where the guess predicts
// it.
class Fake final : public PointFrontend {
 public:
  using PointFrontend::PointFrontend;

  bool forgets_one = false;
  int missing = -1;  // index of the point that is not found

 private:
  void Find(const Frame& /*frame*/, Points* points) override {
    *points = {{100.0F, 100.0F}, {20.0F, 20.0F}, {150.0F, 120.0F}};
  }
  void Follow(const PreparedFrame& from, const Points& points,
              const PreparedFrame& /*to*/, Points* moved,
              Found* found) override {
    EXPECT_FALSE(from.gray.empty());
    EXPECT_EQ(moved->size(), points.size());
    if (missing >= 0) (*found)[missing] = 0;
    if (forgets_one) moved->pop_back();
  }
};

class PointFrontendTest : public ::testing::Test {
 protected:
  PointFrontendTest() : frontend_({camera_}) {
    frame_.gray = cv::Mat(480, 640, CV_8UC1, cv::Scalar(90));
    frame_.depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(10000));  // 2 m
    frame_.depth(cv::Rect(0, 0, 50, 50)) = 0;
  }

  FeatureMatches MatchWithItself(const Rigid3d& guess) {
    FeatureMatches matches{Correspondences(camera_), {}};
    const PreparedFrame frame(frame_);
    frontend_.Match(*frontend_.Detect(frame), frame, guess, &matches);
    return matches;
  }

  Camera camera_;
  Fake frontend_;
  Frame frame_;
};

TEST_F(PointFrontendTest, LeavesOutPointsWithoutDepth) {
  const auto features = frontend_.Detect(PreparedFrame(frame_));
  ASSERT_EQ(features->observations.size(), 2u);
  EXPECT_EQ(features->observations[0].u, 100.0);
  EXPECT_EQ(features->observations[0].depth, 2.0);
  EXPECT_EQ(features->observations[1].u, 150.0);
}

TEST_F(PointFrontendTest, StartsWhereTheGuessHasThem) {
  const FeatureMatches found = MatchWithItself(Moved(0.04, 0.0, 0.0));
  ASSERT_EQ(found.matches.size(), 2u);
  // 0.04 m at 2 m: fx * 0.02
  EXPECT_NEAR(found.matches[0].cur.u, 100.0 + 0.02 * camera_.fx, 1e-4);
  EXPECT_EQ(found.matches[0].cur.depth, 2.0);
}

TEST_F(PointFrontendTest, LeavesOutWhatIsNotFoundOrOutOfTheImage) {
  frontend_.missing = 0;
  EXPECT_EQ(MatchWithItself(Rigid3d()).features, std::vector<int>{1});
  EXPECT_TRUE(MatchWithItself(Moved(-1.0, 0.0, 0.0)).features.empty());
}

TEST_F(PointFrontendTest, RefusesAnAnswerThatLeavesPointsOut) {
  frontend_.forgets_one = true;
  EXPECT_THROW(MatchWithItself(Rigid3d()), InputError);
}

}  // namespace
}  // namespace rgbd_pose
