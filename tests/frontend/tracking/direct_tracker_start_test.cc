// The start of trackers: a motion estimated from coarse images.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/tracking/direct_tracker.h"
#include "frontend/tracking/tracker_factory.h"
#include "tests/support/motions.h"
#include "tests/support/tracker_parts.h"

namespace rgbd_pose {
namespace {

// A fifth of a pixel of the finest level (80 x 60), in full-size pixels.
constexpr double kGoodPx = 1.6;
constexpr double kRounding = 1e-9;

class CoarseStartTest : public ::testing::Test {
 protected:
  CoarseStartTest()
      : dataset_(SyntheticOptions()),
        camera_(dataset_.camera().camera),
        ref_(dataset_.Read(0)),
        cur_(dataset_.Read(15)),
        cur_from_ref_(dataset_.WorldFromCam(15).Inverse() *
                      dataset_.WorldFromCam(0)),
        tracker_({camera_}, *PartsFor(camera_).direct_estimators) {}

  Rigid3d StartOf(const Frame& ref, const Frame& cur, const Rigid3d& guess,
                  const MotionMatrix* guess_covariance = nullptr) {
    TrackingGuess about = guess;
    about.covariance = guess_covariance;
    const auto reference = ReferenceOf(&tracker_, PreparedFrame(ref));
    return tracker_.FindStart(*reference, PreparedFrame(cur), about);
  }

  // RMS distance (px, over a grid) of points from their true positions.
  double ErrorPx(const Rigid3d& motion) const {
    double squares = 0.0;
    int count = 0;
    for (int v = 40; v < ref_.depth.rows - 40; v += 40) {
      for (int u = 40; u < ref_.depth.cols - 40; u += 40) {
        const double depth = ref_.DepthAt(u, v);
        if (depth <= 0.0) continue;
        const Eigen::Vector3d point =
            camera_.Unproject(Eigen::Vector2d(u, v), depth);
        squares += (camera_.Project(motion * point) -
                    camera_.Project(cur_from_ref_ * point))
                       .squaredNorm();
        ++count;
      }
    }
    return std::sqrt(squares / count);
  }

  Rigid3d OffBy(double px, const Eigen::Vector3d& axis) const {
    return Turned(px / camera_.fx, axis) * cur_from_ref_;
  }

  // An image whose pixels do not agree.
  Frame AnotherPlace() const {
    Frame other = cur_;
    cv::rotate(cur_.gray, other.gray, cv::ROTATE_180);
    cv::rotate(cur_.depth, other.depth, cv::ROTATE_180);
    return other;
  }

  SyntheticDataset dataset_;
  Camera camera_;
  Frame ref_, cur_;
  Rigid3d cur_from_ref_;
  DirectTracker tracker_;
};

TEST_F(CoarseStartTest, IsFoundFromFarAway) {
  ASSERT_GT(ErrorPx(Rigid3d()), 10.0) << "the motion is vacuous";
  EXPECT_LT(ErrorPx(StartOf(ref_, cur_, Rigid3d())), kGoodPx);
  for (const double px : {-40.0, 40.0}) {
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
      SCOPED_TRACE(testing::Message() << px << " " << axis.transpose());
      EXPECT_LT(ErrorPx(StartOf(ref_, cur_, OffBy(px, axis))), kGoodPx);
    }
  }
}

TEST_F(CoarseStartTest, DoesNotMindTheExposure) {
  for (const double gain : {0.5, 1.5}) {
    Frame cur = cur_;
    cur_.gray.convertTo(cur.gray, CV_8UC1, gain, -10.0);
    EXPECT_LT(ErrorPx(StartOf(ref_, cur, Rigid3d())), kGoodPx) << gain;
  }
}

// Depth is missing as well, since it could determine the motion, too.
TEST_F(CoarseStartTest, IsTheGuessWhereThereIsNothingToSee) {
  const Rigid3d guess = OffBy(7.0, Eigen::Vector3d::UnitY());
  Frame blind = cur_;
  blind.gray = cv::Mat(cur_.gray.size(), CV_8UC1, cv::Scalar(50));
  blind.depth = cv::Mat(cur_.depth.size(), CV_16UC1, cv::Scalar(0));
  const Rigid3d start = StartOf(ref_, blind, guess);
  EXPECT_LT((start * guess.Inverse()).Angle(), kRounding);
  EXPECT_LT((start.translation - guess.translation).norm(), kRounding);
}

// For an image of another place, even the best fit is no start.
TEST_F(CoarseStartTest, IsTheGuessWhereTooFewAgree) {
  const Rigid3d guess = OffBy(7.0, Eigen::Vector3d::UnitY());
  const Rigid3d start = StartOf(ref_, AnotherPlace(), guess);
  EXPECT_EQ(start.translation, guess.translation);
  EXPECT_EQ(start.rotation.coeffs(), guess.rotation.coeffs());
}

// The same for two frames in a row, of which the first need not be a reference.
TEST_F(CoarseStartTest, FindsTheMotionBetweenTwoFrames) {
  constexpr double kSomePx = 3.0;
  const auto align = [&](const Rigid3d& start) {
    return tracker_.AlignCoarsely(PreparedFrame(ref_), PreparedFrame(cur_),
                                  start, false);
  };
  const auto found = align(Rigid3d());
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(ErrorPx(*found), kSomePx);
  for (int i = 0; i < 3; ++i) {
    const auto from_afar = align(OffBy(20.0, Eigen::Vector3d::Unit(i)));
    ASSERT_TRUE(from_afar.has_value());
    EXPECT_LT(ErrorPx(*from_afar), kSomePx);
  }
}

// A camera that starts to turn after a frame at rest, and depth exposed later
// than colour: the velocity that depth would need is not known yet.
TEST_F(CoarseStartTest, FindsTheMotionWhereDepthIsLateAndTheVelocityChanges) {
  constexpr double kSomePx = 3.0;
  const Frame later = dataset_.Read(18);
  Frame cur = cur_;
  cur.depth = later.depth;
  cur.depth_shutter.offset = later.timestamp - cur.timestamp;
  cur.twist = Twist();
  const Rigid3d later_from_ref =
      dataset_.WorldFromCam(18).Inverse() * dataset_.WorldFromCam(0);
  ASSERT_GT(ErrorPx(later_from_ref), 2.0 * kSomePx) << "depth is not late";
  const auto found = MakeTracker("hybrid", PartsFor(camera_))
                         ->AlignCoarsely(PreparedFrame(ref_),
                                         PreparedFrame(cur), Rigid3d(), true);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(ErrorPx(*found), kSomePx);
}

// Gray levels come first there, but a view without any needs depth.
TEST_F(CoarseStartTest, FindsTheMotionByDepthWhereGrayLevelsShowNothing) {
  constexpr double kSomePx = 3.0;
  Frame ref = ref_;
  Frame cur = cur_;
  for (Frame* frame : {&ref, &cur}) {
    frame->gray = cv::Mat(frame->gray.size(), CV_8UC1, cv::Scalar(50));
    frame->color_shutter.readout = 0.01;
    frame->twist = Twist();
  }
  const auto found = MakeTracker("hybrid", PartsFor(camera_))
                         ->AlignCoarsely(PreparedFrame(ref), PreparedFrame(cur),
                                         Rigid3d(), true);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(ErrorPx(*found), kSomePx);
}

TEST_F(CoarseStartTest, SaysNothingOfTwoFramesThatShowNothing) {
  const auto align = [&](const Frame& prev, const Frame& cur) {
    return tracker_.AlignCoarsely(PreparedFrame(prev), PreparedFrame(cur),
                                  Rigid3d(), false);
  };
  const auto black = [](Frame frame) {
    frame.gray = cv::Mat(frame.gray.size(), CV_8UC1, cv::Scalar(0));
    frame.depth = cv::Mat(frame.depth.size(), CV_16UC1, cv::Scalar(0));
    return frame;
  };
  EXPECT_FALSE(align(black(ref_), black(cur_)).has_value());
  EXPECT_FALSE(align(ref_, black(cur_)).has_value());
  EXPECT_FALSE(align(black(ref_), cur_).has_value());
  EXPECT_FALSE(align(ref_, AnotherPlace()).has_value());
}

TEST_F(CoarseStartTest, EveryTrackerWithPixelsAlignsTwoFrames) {
  const PreparedFrame ref(ref_), cur(cur_);
  const auto expected = tracker_.AlignCoarsely(ref, cur, Rigid3d(), false);
  ASSERT_TRUE(expected.has_value());
  for (const std::string& name : TrackerNames()) {
    const auto found = MakeTracker(name, PartsFor(camera_))
                           ->AlignCoarsely(ref, cur, Rigid3d(), false);
    ASSERT_TRUE(found.has_value()) << name;
    EXPECT_EQ(found->translation, expected->translation) << name;
  }
  TrackerParts parts = PartsFor(camera_);
  parts.direct_estimators.reset();
  EXPECT_FALSE(MakeTracker("features", std::move(parts))
                   ->AlignCoarsely(ref, cur, Rigid3d(), false)
                   .has_value());
}

// A guess with a small covariance is kept.
TEST_F(CoarseStartTest, StaysWithACertainGuess) {
  const Rigid3d guess = OffBy(40.0, Eigen::Vector3d::UnitY());
  const MotionMatrix certain = 1e-12 * MotionMatrix::Identity();
  const Rigid3d start = StartOf(ref_, cur_, guess, &certain);
  EXPECT_NEAR(ErrorPx(start), 40.0, 5.0);
}

}  // namespace
}  // namespace rgbd_pose
