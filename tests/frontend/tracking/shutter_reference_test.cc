// When and by which velocity a reference with rolling shutters is moved. The
// tracker of these tests finds the motion that it is told.

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

#include "frontend/tracking/shutter_tracking.h"
#include "tests/support/fake_tracker.h"

namespace rgbd_pose {
namespace {

constexpr double kInterval = 1.0 / 30.0;  // s
constexpr double kMiddle = -0.0075;       // s, exposure of the middle row
constexpr double kTolerance = 0.03;       // relative: three rounds

// How a velocity moves the motion of these frames: as the middle row is seen.
const MotionMatrix kMotionByTwist = kMiddle * MotionMatrix::Identity();

struct Move {
  Twist twist;
  Rigid3d reference_from_stamp;
};

// Keeps how its reference was moved.
class MovingTracker final : public FakeTracker {
 public:
  MovingTracker() {
    images_.camera = {320, 240, 262.5, 262.5, 159.5, 119.5, 0, 0, 0};
  }
  void MoveReference(const PreparedFrame& frame,
                     const Rigid3d& reference_from_stamp,
                     Reference* /*reference*/) const override {
    moves.push_back({*frame.twist, reference_from_stamp});
  }

  mutable std::vector<Move> moves;
};

PreparedFrame FrameAt(double timestamp, const std::optional<Twist>& twist) {
  Frame frame;
  frame.timestamp = timestamp;
  frame.color_shutter = {kMiddle, 0.028};
  frame.depth_shutter = {-0.018, 0.028};
  frame.twist = twist;
  return PreparedFrame(frame);
}

class ShutterReferenceTest : public ::testing::Test {
 protected:
  // Follows a frame of a camera with a constant velocity `twist` after a frame
  // that became a reference with the velocity `first`. `guess`: of the
  // velocity.
  void Follow(const std::optional<Twist>& first, const Twist& twist,
              const std::optional<Twist>& guess = std::nullopt) {
    reference_.frame = FrameAt(0.0, first);
    reference_.reference = std::make_unique<Reference>();
    ShutterTracking shutter(&tracker_);
    TrackingResult tracked(tracker_.images().camera);
    if (first.has_value()) {
      tracked.velocity =
          TwistEstimate{*first, IndependentErrors(sigma_, sigma_),
                        kMotionByTwist, MotionMatrix::Zero()};
      shutter.Restart(reference_.frame, tracked);
    }
    shutter.AddReference(&reference_);
    tracked.estimate.cur_from_prev = twist.MotionDuring(kInterval);
    if (first.has_value()) {
      // What the middle row has seen stays, whatever the velocity was.
      tracked.estimate.cur_from_prev = tracked.estimate.cur_from_prev *
                                       twist.MotionDuring(kMiddle).Inverse() *
                                       first->MotionDuring(kMiddle);
    }
    const auto find = [&](const PreparedFrame& /*frame*/,
                          const VelocityPrior* velocity) {
      tracked.velocity.reset();
      if (velocity != nullptr) {
        reference_covariance_ = velocity->reference_covariance;
        tracked.velocity = TwistEstimate{twist};
      }
      return true;
    };
    const auto find_again = [&](const PreparedFrame& frame,
                                const VelocityPrior& velocity,
                                const Rigid3d& /*cur_from_ref*/) {
      ++num_corrected_;
      return find(frame, &velocity);
    };
    const PreparedFrame* const found = shutter.Follow(
        FrameAt(kInterval, std::nullopt), kInterval, Rigid3d(), guess,
        std::nullopt, &reference_, tracked, find, find_again);
    ASSERT_NE(found, nullptr);
    found_ = *found;
  }

  MovingTracker tracker_;
  OdometryKeyframe reference_;
  PreparedFrame found_;
  MotionMatrix reference_covariance_ = MotionMatrix::Zero();
  double sigma_ = 100.0;  // of the first velocity, rad/s and m/s
  int num_corrected_ = 0;
};

const Twist kHand = {{0.3, -0.5, 0.2}, {0.2, 0.3, -0.1}};

TEST_F(ShutterReferenceTest, WithoutAVelocityItGetsThatSinceThen) {
  Follow(std::nullopt, kHand);
  ASSERT_GE(tracker_.moves.size(), 2u);
  EXPECT_EQ(static_cast<int>(tracker_.moves.size()), num_corrected_);
  const Move& last = tracker_.moves.back();
  EXPECT_LT((last.twist.angular - kHand.angular).norm(),
            kTolerance * kHand.angular.norm());
  EXPECT_LT((last.twist.linear - kHand.linear).norm(),
            kTolerance * kHand.linear.norm());
  // Its pose counts as that at the stamp.
  EXPECT_LT(last.reference_from_stamp.translation.norm(), 1e-12);
  EXPECT_LT(last.reference_from_stamp.Angle(), 1e-7);
  EXPECT_EQ(reference_.frame.twist->angular, last.twist.angular);
  EXPECT_EQ(found_.twist->linear, kHand.linear);
}

TEST_F(ShutterReferenceTest, WithoutAVelocityItGetsTheGuessFirst) {
  Follow(std::nullopt, kHand, kHand);
  ASSERT_EQ(tracker_.moves.size(), 1u);
  EXPECT_EQ(tracker_.moves[0].twist.linear, kHand.linear);
  EXPECT_EQ(num_corrected_, 0) << "the guess was right";
}

// What a frame with another velocity has seen stays where it was found: here,
// when the middle row was exposed.
TEST_F(ShutterReferenceTest, WithAnotherVelocityItsAxesLeaveTheStamp) {
  const Twist first = 0.5 * kHand;
  Follow(first, kHand);
  ASSERT_GE(tracker_.moves.size(), 1u);
  const Move& last = tracker_.moves.back();
  const Rigid3d expected =
      first.MotionDuring(kMiddle).Inverse() * last.twist.MotionDuring(kMiddle);
  // A Kalman filter is linear: products of two angles remain.
  const Rigid3d off = expected.Inverse() * last.reference_from_stamp;
  EXPECT_LT(off.translation.norm(), 1e-5);
  EXPECT_LT(off.Angle(), 1e-5);
  EXPECT_LT((last.twist.angular - kHand.angular).norm(), 1e-3);
  EXPECT_GT(last.reference_from_stamp.Angle(), 0.001);
  EXPECT_EQ(reference_.reference_from_stamp.translation,
            last.reference_from_stamp.translation);
}

TEST_F(ShutterReferenceTest, AVelocityKnownBetterMovesLess) {
  const Twist first = 0.5 * kHand;
  sigma_ = 0.05;
  Follow(first, kHand);
  ASSERT_GE(tracker_.moves.size(), 1u);
  const double moved =
      (tracker_.moves.back().twist.angular - first.angular).norm();
  EXPECT_LT(moved, 0.5 * (kHand.angular - first.angular).norm());
  EXPECT_GT(moved, 1e-3);
}

// Frames that are tracked against it know how well its velocity is known.
TEST_F(ShutterReferenceTest, ItsVelocityBecomesMoreCertain) {
  sigma_ = 0.3;
  Follow(0.5 * kHand, kHand);
  EXPECT_EQ(reference_covariance_, reference_.velocity_covariance);
  EXPECT_LT(reference_covariance_.diagonal().maxCoeff(), 0.5 * 0.3 * 0.3);
  EXPECT_GT(reference_covariance_.diagonal().minCoeff(), 0.0);
}

// A recording often begins on a tripod or a table.
TEST_F(ShutterReferenceTest, AStillCameraIsKnownToHaveStoodStill) {
  Follow(std::nullopt, Twist());
  EXPECT_TRUE(tracker_.moves.empty());
  EXPECT_LT(reference_.velocity_covariance.trace(),
            0.1 * VelocityModel::CovarianceOfUnknown().trace());
}

TEST_F(ShutterReferenceTest, ASmallChangeMovesNothing) {
  Follow(kHand, 1.01 * kHand);
  EXPECT_TRUE(tracker_.moves.empty());
  EXPECT_EQ(num_corrected_, 0);
}

// A wrong motion is no reason to move a reference that others are tracked
// against later.
TEST_F(ShutterReferenceTest, AMotionThatNoHandMakesLeavesItWhereItWas) {
  Follow(kHand, {{}, {30.0, 0.0, 0.0}});
  EXPECT_FALSE(found_.twist.has_value());
  EXPECT_LT(reference_.frame.twist->linear.norm(), 4.0);
  if (tracker_.moves.empty()) return;
  EXPECT_LT(tracker_.moves.back().twist.linear.norm(), 4.0);
}

}  // namespace
}  // namespace rgbd_pose
