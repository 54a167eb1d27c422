// In which order guesses are tried, and which pose is kept.

#include "frontend/tracking/tracking_attempts.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace rgbd_pose {
namespace {

using Status = TrackingStatus;

struct EmptyReference final : Reference {
  Overlap SeenFrom(const Rigid3d& /*cur_from_ref*/) const override {
    return {};
  }
};

// The status that a guess leads to without and with the slow methods.
struct Outcome {
  Status quick, full;
};

constexpr double kFirst = 1.0, kSecond = 2.0;  // x of the guesses, m

Rigid3d At(double x) {
  return Rigid3d(Eigen::Quaterniond::Identity(), {x, 0.0, 0.0});
}

// Returns the guess as the pose. Skips the slow methods of a tentative guess.
class ScriptedTracker final : public Tracker {
 public:
  ScriptedTracker(Outcome first, Outcome second)
      : first_(first), second_(second) {}

  void Prepare(const PreparedFrame& /*frame*/) const override {}
  std::unique_ptr<Reference> MakeReference(const PreparedFrame& /*frame*/,
                                           const Reference* /*last*/,
                                           const TrackingResult* /*tracked*/,
                                           std::string* /*why_not*/) override {
    return std::make_unique<EmptyReference>();
  }

  void Track(const Reference& /*reference*/, const PreparedFrame& /*frame*/,
             const TrackingGuess& guess, TrackingResult* tracked) override {
    const double x = guess.cur_from_ref.translation.x();
    const Outcome& outcome = x == kFirst ? first_ : second_;
    tracked->status = outcome.quick;
    tracked->estimate.cur_from_prev = guess.cur_from_ref;
    const bool is_good = outcome.quick == Status::kOk;
    tracked->is_partial = guess.is_tentative && !is_good;
    if (!is_good && !guess.is_tentative) {
      tracked->status = outcome.full;
      ++num_slow;
    }
  }

  const FrontendOptions& images() const override { return images_; }

  int num_slow = 0;

 private:
  FrontendOptions images_;
  Outcome first_, second_;
};

// The guess that the kept pose comes from (0: no pose), its status, and how
// often the slow methods ran.
struct Attempt {
  double kept = 0.0;
  Status status = Status::kLost;
  int num_slow = 0;
};

Attempt TryEither(Outcome first, Outcome second) {
  ScriptedTracker tracker(first, second);
  TrackingAttempts attempts(&tracker);
  OdometryKeyframe keyframe;
  keyframe.reference = std::make_unique<EmptyReference>();
  TrackedFrame result;
  const bool is_found = attempts.TryEither(PreparedFrame(Frame()), keyframe,
                                           At(kFirst), At(kSecond), &result);
  return {
      is_found ? attempts.kept().estimate.cur_from_prev.translation.x() : 0.0,
      result.status, tracker.num_slow};
}

TEST(TrackingAttemptsTest, AGoodFirstGuessIsEnough) {
  const Attempt attempt =
      TryEither({Status::kOk, Status::kOk}, {Status::kOk, Status::kOk});
  EXPECT_EQ(attempt.kept, kFirst);
  EXPECT_EQ(attempt.num_slow, 0);
}

TEST(TrackingAttemptsTest, TheSecondGuessComesBeforeSlowMethods) {
  for (const Status quick : {Status::kDegraded, Status::kLost}) {
    const Attempt attempt =
        TryEither({quick, Status::kOk}, {Status::kOk, Status::kOk});
    EXPECT_EQ(attempt.kept, kSecond);
    EXPECT_EQ(attempt.status, Status::kOk);
    EXPECT_EQ(attempt.num_slow, 0);
  }
}

TEST(TrackingAttemptsTest, SlowMethodsRunIfNoGuessIsGood) {
  const Attempt attempt = TryEither({Status::kLost, Status::kOk},
                                    {Status::kLost, Status::kDegraded});
  EXPECT_EQ(attempt.kept, kFirst);
  EXPECT_EQ(attempt.status, Status::kOk);
  EXPECT_EQ(attempt.num_slow, 2);
}

TEST(TrackingAttemptsTest, OfTwoDoubtfulPosesTheFirstIsKept) {
  const Attempt attempt = TryEither({Status::kLost, Status::kDegraded},
                                    {Status::kDegraded, Status::kDegraded});
  EXPECT_EQ(attempt.kept, kFirst);
  EXPECT_EQ(attempt.status, Status::kDegraded);
}

TEST(TrackingAttemptsTest, ADoubtfulPoseIsBetterThanNone) {
  const Attempt attempt = TryEither({Status::kLost, Status::kLost},
                                    {Status::kDegraded, Status::kDegraded});
  EXPECT_EQ(attempt.kept, kSecond);
  EXPECT_EQ(attempt.status, Status::kDegraded);
  EXPECT_EQ(
      TryEither({Status::kLost, Status::kLost}, {Status::kLost, Status::kLost})
          .kept,
      0.0);
}

}  // namespace
}  // namespace rgbd_pose
