// References of a rolling shutter whose velocity becomes known later.

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>

#include "frontend/tracking/tracker_factory.h"
#include "tests/support/motion_error.h"
#include "tests/support/rolling_frame.h"
#include "tests/support/tracker_parts.h"

namespace rgbd_pose {
namespace {

constexpr int kRef = 30;
constexpr int kCur = 33;
constexpr double kRounding = 1e-7;

class MovedReferenceTest : public ::testing::TestWithParam<std::string> {
 protected:
  MovedReferenceTest()
      : ref_(RollingFrame(kRef)),
        cur_(RollingFrame(kCur)),
        tracker_(MakeTracker(GetParam(),
                             PartsFor(HandheldOptions().camera.camera))) {}

  // A reference made with this velocity.
  std::unique_ptr<Reference> Make(const std::optional<Twist>& twist) {
    return ReferenceOf(tracker_.get(), ref_.WithTwist(twist));
  }

  TrackingResult Track(const Reference& reference) {
    TrackingResult tracked(tracker_->images().camera);
    tracker_->Track(reference, cur_, Rigid3d(), &tracked);
    EXPECT_NE(tracked.status, TrackingStatus::kLost) << tracked.reason;
    return tracked;
  }

  PreparedFrame ref_, cur_;
  std::unique_ptr<Tracker> tracker_;
};

TEST_P(MovedReferenceTest, GivesTheMotionThatAFreshOneGives) {
  const Rigid3d truth = HandheldMotion(kRef, kCur);
  const TrackingResult fresh = Track(*Make(ref_.twist));
  const Rigid3d aside = Rigid3d::FromRotationVector({0.002, -0.004, 0.003},
                                                    {0.002, 0.003, 0.001});
  for (const std::optional<Twist>& first :
       {std::optional<Twist>(), std::optional(0.5 * *ref_.twist)}) {
    for (const Rigid3d& reference_from_stamp : {Rigid3d(), aside}) {
      const auto reference = Make(first);
      TrackingResult tracked = Track(*reference);
      const MotionError before =
          ErrorOf(tracked.estimate.cur_from_prev, fresh.estimate.cur_from_prev);
      tracker_->MoveReference(ref_, reference_from_stamp, reference.get());
      tracker_->TrackAgain(*reference, cur_,
                           Rigid3d(tracked.estimate.cur_from_prev), &tracked);
      const Rigid3d found =
          tracked.estimate.cur_from_prev * reference_from_stamp;
      const MotionError off = ErrorOf(found, fresh.estimate.cur_from_prev);
      EXPECT_EQ(tracked.status, TrackingStatus::kOk) << tracked.reason;
      EXPECT_EQ(tracked.source, fresh.source);
      // Starts and the patches found differ. Without the right velocity the
      // motion is off by 0.01 to 0.024 rad and 0.01 to 0.03 m.
      ASSERT_GT(before.angle, 0.008) << "nothing to undo";
      EXPECT_LT(off.angle, 0.08 * before.angle);
      EXPECT_LT(off.translation, 0.08 * before.translation);
      EXPECT_LT(ErrorOf(found, truth).angle, 0.0025);
      EXPECT_LT(ErrorOf(found, truth).translation, 0.002);
    }
  }
}

// A reference is moved often, but its frame is prepared once.
TEST_P(MovedReferenceTest, MovedBackItIsWhatItWas) {
  const auto reference = Make(ref_.twist);
  const TrackingResult before = Track(*reference);
  const Rigid3d aside =
      Rigid3d::FromRotationVector({0.1, 0.0, 0.0}, {0.0, 0.2, 0.0});
  tracker_->MoveReference(ref_.WithTwist(std::nullopt), aside, reference.get());
  tracker_->MoveReference(ref_, Rigid3d(), reference.get());
  const TrackingResult after = Track(*reference);
  const MotionError off =
      ErrorOf(after.estimate.cur_from_prev, before.estimate.cur_from_prev);
  EXPECT_LT(off.angle, kRounding);
  EXPECT_LT(off.translation, kRounding);
  EXPECT_EQ(after.estimate.num_inliers, before.estimate.num_inliers);
}

INSTANTIATE_TEST_SUITE_P(Trackers, MovedReferenceTest,
                         ::testing::ValuesIn(TrackerNames()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace rgbd_pose
