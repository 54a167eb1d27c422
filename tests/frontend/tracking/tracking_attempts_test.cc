// In which order guesses are tried, and which pose is kept.

#include "frontend/tracking/tracking_attempts.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/fake_tracker.h"
#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

using Status = TrackingStatus;

// The status that a guess leads to without and with the slow methods.
struct Outcome {
  Status quick, full;
  bool is_ambiguous = false;  // a pose that slow methods do not change
};

constexpr Outcome kGood = {Status::kOk, Status::kOk};
constexpr Outcome kNone = {Status::kLost, Status::kLost};

constexpr double kFirst = 1.0, kSecond = 2.0, kThird = 3.0;  // x of guesses, m

Rigid3d At(double x) { return Moved(x, 0.0, 0.0); }

// Returns the guess as the pose. Skips the slow methods of a tentative guess.
class ScriptedTracker final : public FakeTracker {
 public:
  ScriptedTracker(Outcome first, Outcome second, Outcome third)
      : first_(first), second_(second), third_(third) {}

  void Track(const Reference& /*reference*/, const PreparedFrame& /*frame*/,
             const TrackingGuess& guess, TrackingResult* tracked) override {
    const double x = guess.cur_from_ref.translation.x();
    const Outcome& outcome =
        x == kFirst ? first_ : (x == kSecond ? second_ : third_);
    tracked->status = outcome.quick;
    tracked->estimate.cur_from_prev = guess.cur_from_ref;
    tracked->estimate.iterations = 1;
    tracked->match_ms = 1.0;
    ++num_tracked;
    const bool is_good = outcome.quick == Status::kOk;
    tracked->is_ambiguous = outcome.is_ambiguous;
    tracked->is_partial =
        guess.is_tentative && !is_good && !outcome.is_ambiguous;
    if (!is_good && !guess.is_tentative && !outcome.is_ambiguous) {
      tracked->status = outcome.full;
      ++num_slow;
    }
  }

  // Moves on from the guess by 10 m.
  void TrackAgain(const Reference& /*reference*/,
                  const PreparedFrame& /*frame*/, const TrackingGuess& guess,
                  TrackingResult* tracked) override {
    tracked->estimate.cur_from_prev = At(10.0) * guess.cur_from_ref;
    tracked->estimate.iterations = 2;
    tracked->match_ms += 0.25;
    ++num_again;
  }

  void Refine(const Reference& /*reference*/, const PreparedFrame& /*frame*/,
              const TrackingGuess& /*guess*/,
              TrackingResult* tracked) override {
    tracked->overlap.share = 1.0;
    ++num_refined;
  }

  int num_tracked = 0;
  int num_slow = 0;
  int num_again = 0;
  int num_refined = 0;

 private:
  Outcome first_, second_, third_;
};

// The guess that the kept pose comes from (0: no pose), its status, how often
// the slow methods ran and whether a third guess was searched for.
struct Attempt {
  double kept = 0.0;
  Status status = Status::kLost;
  int num_slow = 0;
  bool has_searched = false;
};

Attempt TryInTurn(Outcome first, Outcome second, Outcome third) {
  ScriptedTracker tracker(first, second, third);
  TrackingAttempts attempts(&tracker);
  OdometryKeyframe keyframe;
  keyframe.reference = std::make_unique<Reference>();
  TrackedFrame result;
  Attempt attempt;
  if (attempts.TryInTurn(
          PreparedFrame(Frame()), keyframe, At(kFirst), At(kSecond),
          [&](Rigid3d* cur_from_ref) {
            attempt.has_searched = true;
            *cur_from_ref = At(kThird);
            return true;
          },
          &result)) {
    attempt.kept = attempts.kept().estimate.cur_from_prev.translation.x();
  }
  EXPECT_EQ(result.iterations, tracker.num_tracked);
  attempt.status = result.status;
  attempt.num_slow = tracker.num_slow;
  return attempt;
}

void ExpectAttempt(const Attempt& attempt, const Attempt& expected) {
  EXPECT_EQ(attempt.kept, expected.kept);
  EXPECT_EQ(attempt.status, expected.status);
  EXPECT_EQ(attempt.num_slow, expected.num_slow);
  EXPECT_EQ(attempt.has_searched, expected.has_searched);
}

TEST(TrackingAttemptsTest, TheFirstOfTheBestPosesIsKept) {
  ExpectAttempt(TryInTurn(kGood, kGood, kGood),
                {kFirst, Status::kOk, 0, false});
  // Slow methods run if no guess is good.
  const Outcome late_good = {Status::kLost, Status::kOk};
  const Outcome late = {Status::kLost, Status::kDegraded};
  ExpectAttempt(TryInTurn(late_good, late, kNone),
                {kFirst, Status::kOk, 1, true});
  // Of two doubtful poses the first is kept; one is better than none.
  const Outcome doubtful = {Status::kDegraded, Status::kDegraded};
  ExpectAttempt(TryInTurn(late, doubtful, kNone),
                {kFirst, Status::kDegraded, 1, true});
  ExpectAttempt(TryInTurn(kNone, doubtful, kNone),
                {kSecond, Status::kDegraded, 2, true});
  EXPECT_EQ(TryInTurn(kNone, kNone, kNone).kept, 0.0);
  // What descriptors find does not replace an ambiguous pose.
  Outcome ambiguous = doubtful;
  ambiguous.is_ambiguous = true;
  const Attempt attempt = TryInTurn(ambiguous, doubtful, kGood);
  EXPECT_EQ(attempt.kept, kFirst);
  EXPECT_EQ(attempt.status, Status::kDegraded);
  EXPECT_FALSE(attempt.has_searched);
}

TEST(TrackingAttemptsTest, OtherGuessesComeBeforeSlowMethods) {
  for (const Status quick : {Status::kDegraded, Status::kLost}) {
    for (const double good : {kSecond, kThird}) {
      const Attempt attempt = TryInTurn(
          {quick, Status::kOk},
          good == kSecond ? kGood : Outcome{quick, Status::kOk}, kGood);
      ExpectAttempt(attempt, {good, Status::kOk, 0, good == kThird});
    }
  }
}

TEST(TrackingAttemptsTest, ACorrectionReplacesThePoseAndAddsItsTime) {
  ScriptedTracker tracker(kGood, kNone, kNone);
  TrackingAttempts attempts(&tracker);
  OdometryKeyframe keyframe;
  keyframe.reference = std::make_unique<Reference>();
  TrackedFrame result;
  const PreparedFrame frame{Frame()};
  ASSERT_TRUE(attempts.Try(frame, keyframe, At(kFirst), &result));
  const TrackingResult first = attempts.kept();
  ASSERT_TRUE(attempts.TryAgain(frame, keyframe, At(kFirst), &result));
  EXPECT_EQ(attempts.kept().estimate.cur_from_prev.translation.x(),
            kFirst + 10.0);
  EXPECT_EQ(result.iterations, 3);
  EXPECT_EQ(result.match_ms, 1.25);  // the time of Track counts once
  EXPECT_EQ(tracker.num_tracked, 1);
  EXPECT_EQ(tracker.num_again, 1);
  attempts.Restore(first);
  EXPECT_EQ(attempts.kept().estimate.cur_from_prev.translation.x(), kFirst);
}

TEST(TrackingAttemptsTest, OnlyWhatIsAcceptedIsRefinedAndJudgedAgain) {
  ScriptedTracker tracker(kGood, kGood, kNone);
  TrackingAttempts attempts(&tracker);
  OdometryKeyframe keyframe;
  keyframe.reference = std::make_unique<Reference>();
  TrackedFrame result;
  const PreparedFrame frame{Frame()};
  ASSERT_TRUE(attempts.Try(frame, keyframe, At(kFirst), &result));
  const auto from_second = [&](const TrackingAttempts::Accept& accept) {
    return attempts.TryFallback(frame, keyframe, At(kSecond), &result, accept);
  };
  const auto kept_x = [&] {
    return attempts.kept().estimate.cur_from_prev.translation.x();
  };
  EXPECT_FALSE(from_second([] { return false; }));
  EXPECT_EQ(tracker.num_refined, 0);
  EXPECT_EQ(kept_x(), kFirst);
  const auto is_seen = [&] { return attempts.kept().overlap.share > 0.5; };
  EXPECT_FALSE(from_second([&] { return !is_seen(); }));
  EXPECT_EQ(tracker.num_refined, 1);
  EXPECT_EQ(kept_x(), kFirst);
  EXPECT_TRUE(from_second([] { return true; }));
  EXPECT_EQ(tracker.num_refined, 2);
  EXPECT_TRUE(is_seen());
  EXPECT_EQ(kept_x(), kSecond);
  EXPECT_EQ(result.iterations, tracker.num_tracked);
}

}  // namespace
}  // namespace rgbd_pose
