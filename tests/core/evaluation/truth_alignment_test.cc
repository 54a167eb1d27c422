#include "core/evaluation/truth_alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/geometry/twist.h"
#include "core/util/units.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// The pose of a body at a time (s): position (m) and rotation vector (rad).
using BodyPath = std::function<Rigid3d(double)>;

Rigid3d PoseOf(const Vector3d& place, const Vector3d& turn) {
  return Rigid3d(Twist{turn, Vector3d::Zero()}.MotionDuring(-1.0).rotation,
                 place);
}

// A handheld camera: 0.3 m/s and 0.5 rad/s, in all directions.
Rigid3d Hand(double t) {
  return PoseOf(
      0.15 * Vector3d(std::sin(2.0 * t), std::sin(1.6 * t), std::cos(2.3 * t)),
      0.3 * Vector3d(std::sin(1.7 * t), std::cos(1.3 * t), std::sin(2.1 * t)));
}

Rigid3d HandWithoutTurns(double t) {
  return PoseOf(Hand(t).translation, {0.1, 0.2, 0.3});
}

// Planar motion in z = 0, with rotation about z.
Rigid3d Wheels(double t) {
  return PoseOf({0.5 * std::sin(0.9 * t), 0.4 * std::sin(1.4 * t), 0.0},
                {0.0, 0.0, 0.6 * std::sin(1.1 * t)});
}

Rigid3d Line(double t) { return PoseOf({0.5 * t, 0.0, 0.0}, {0.1, 0.2, 0.3}); }

Rigid3d Still(double) { return PoseOf({1.0, 2.0, 3.0}, {0.1, 0.2, 0.3}); }

struct Recording {
  BodyPath path = Hand;
  TruthFixing fixing;
  double seconds = 20.0;
  double truth_rate = 100.0;   // Hz
  double place_noise = 0.001;  // m, of the estimate
  double turn_noise = 0.001;   // rad, of the estimate
  double truth_share = 0.1;    // noise of the truth / noise of the estimate
  double frame_rate = 30.0;    // Hz
  double jitter = 0.003;       // s, of the frames' times
  double jump_every = 1e9;     // s; jumps of 5 cm and 3 degrees
  unsigned seed = 1;
};

struct Trajectories {
  Trajectory estimate;
  Trajectory truth;
};

Trajectories Record(const Recording& recording) {
  RandomWorld random(recording.seed);
  const auto noisy = [&](const Rigid3d& pose, double share) {
    const auto normal = [&](double sigma) {
      return Vector3d(random.Normal(sigma), random.Normal(sigma),
                      random.Normal(sigma));
    };
    return pose * PoseOf(normal(share * recording.place_noise),
                         normal(share * recording.turn_noise));
  };
  Trajectories made;
  for (int i = 0; i < recording.seconds * recording.truth_rate; ++i) {
    const double t = i / recording.truth_rate;
    made.truth.push_back({t, noisy(recording.path(t), recording.truth_share)});
  }
  Rigid3d world = PoseOf({3.0, -1.0, 2.0}, {0.5, 1.0, -0.4});
  const Rigid3d body_from_camera = recording.fixing.camera_from_body.Inverse();
  double next_jump = recording.jump_every;
  for (int i = 0; i < recording.seconds * recording.frame_rate; ++i) {
    const double t = i / recording.frame_rate +
                     random.Uniform(-recording.jitter, recording.jitter);
    if (t > next_jump) {
      next_jump += recording.jump_every;
      world = world * PoseOf({0.05, 0.0, 0.0}, {0.0, 0.05, 0.0});
    }
    made.estimate.push_back(
        {t, world * noisy(recording.path(t + recording.fixing.shift) *
                              body_from_camera,
                          1.0)});
  }
  return made;
}

TruthAlignment Align(const Recording& recording) {
  const Trajectories made = Record(recording);
  return AlignTruth(made.estimate, made.truth, 1.0, 0.02);
}

TruthFixing SomeFixing() {
  return {-0.0183, PoseOf({-0.012, 0.004, 0.031},
                          kRadiansPerDegree * Vector3d(1.4, 0.45, -0.9))};
}

// [shift, rotation, lever] in s, rad and m.
FixingVector AsVector(const TruthFixing& fixing) {
  FixingVector vector;
  vector << fixing.shift, TwistOf(fixing.camera_from_body, -1.0).angular,
      fixing.camera_from_body.translation;
  return vector;
}

// None of 7 x 40 normal deviates is expected beyond this. Their mean square
// would be within 1 +- 0.3 if the sigmas were known exactly.
constexpr double kMaxDeviation = 4.5;

TEST(TruthAlignmentTest, FindsClockAndFixingWithHonestErrorBars) {
  Recording recording;
  recording.fixing = SomeFixing();
  double sum = 0.0;
  for (recording.seed = 1; recording.seed <= 40; ++recording.seed) {
    const TruthAlignment found = Align(recording);
    ASSERT_EQ(found.skipped, "");
    EXPECT_THAT(found.undetermined, IsEmpty());
    const FixingVector deviation =
        (AsVector(found.fixing) - AsVector(recording.fixing))
            .cwiseQuotient(found.sigma);
    EXPECT_LT(deviation.cwiseAbs().maxCoeff(), kMaxDeviation)
        << deviation.transpose();
    sum += deviation.squaredNorm() / 7.0 / 40.0;
    // Determined to better than 0.5 ms, 0.1 degrees and 2 mm.
    EXPECT_LT(found.sigma[0], 0.0005);
    EXPECT_LT(found.sigma.segment<3>(1).maxCoeff(), 0.1 * kRadiansPerDegree);
    EXPECT_LT(found.sigma.tail<3>().maxCoeff(), 0.002);
  }
  EXPECT_GT(sum, 0.4);
  EXPECT_LT(sum, 1.6);
}

// After the alignment, the remaining errors are the simulated noise.
TEST(TruthAlignmentTest, ErrorsThereAreThoseOfTheEstimate) {
  Recording recording;
  recording.fixing = SomeFixing();
  const TruthAlignment found = Align(recording);
  EXPECT_GT(found.ate.count, 590);  // of 600
  EXPECT_NEAR(found.ate.rmse, std::sqrt(3.0) * recording.place_noise, 0.0002);
  EXPECT_GT(found.rpe_seconds.translation.count, 560);
  EXPECT_NEAR(found.rpe_seconds.translation.rmse,
              std::sqrt(6.0) * recording.place_noise, 0.0003);
  EXPECT_NEAR(found.rpe_seconds.rotation.rmse,
              std::sqrt(6.0) * recording.turn_noise, 0.0003);
}

TEST(TruthAlignmentTest, FindsNothingWhereNothingIs) {
  const TruthAlignment found = Align(Recording());
  EXPECT_THAT(found.undetermined, IsEmpty());
  EXPECT_LT(
      AsVector(found.fixing).cwiseQuotient(found.sigma).cwiseAbs().maxCoeff(),
      kMaxDeviation);
}

// The truth as its own estimate: no errors from which to estimate a spread.
TEST(TruthAlignmentTest, TheTruthAgreesWithItself) {
  const Trajectory truth = Record({}).truth;
  const TruthAlignment found = AlignTruth(truth, truth, 1.0, 0.02);
  EXPECT_EQ(found.skipped, "");
  EXPECT_THAT(found.undetermined, IsEmpty());
  EXPECT_LT(AsVector(found.fixing).norm(), 1e-12);
  EXPECT_LT(found.ate.max, 1e-12);
}

TEST(TruthAlignmentTest, FindsLargeOnesAndBearsJumps) {
  Recording recording;
  recording.fixing = {0.15, PoseOf({0.3, -0.1, 0.2}, {0.0, 0.4, -0.2})};
  recording.jump_every = 1.0;
  const TruthAlignment found = Align(recording);
  ASSERT_EQ(found.skipped, "");
  EXPECT_THAT(found.undetermined, IsEmpty());
  EXPECT_LT((AsVector(found.fixing) - AsVector(recording.fixing))
                .cwiseQuotient(found.sigma)
                .cwiseAbs()
                .maxCoeff(),
            kMaxDeviation);
}

// Undetermined components are named and remain 0, except for a small leak from
// the determined directions because of noise (in m; 1e-6 s).
constexpr double kOpenTolerance = 1e-4;

TEST(TruthAlignmentTest, WithoutTurnsTheLeverIsOpen) {
  Recording recording;
  recording.path = HandWithoutTurns;
  recording.fixing = SomeFixing();
  for (recording.seed = 1; recording.seed <= 5; ++recording.seed) {
    const TruthAlignment found = Align(recording);
    EXPECT_THAT(found.undetermined, ElementsAre("lever"));
    EXPECT_LT(found.fixing.camera_from_body.translation.norm(), kOpenTolerance);
    EXPECT_TRUE(std::isinf(found.sigma.tail<3>().minCoeff()));
    EXPECT_NEAR(found.fixing.shift, recording.fixing.shift, 0.001);
    EXPECT_LT(found.sigma[0], 0.001);
  }
}

TEST(TruthAlignmentTest, OnAPlaneTheLeverAlongItsNormalIsOpen) {
  Recording recording;
  recording.path = Wheels;
  recording.fixing = {0.01, PoseOf({0.03, -0.02, 0.0}, Vector3d::Zero())};
  for (recording.seed = 1; recording.seed <= 5; ++recording.seed) {
    const TruthAlignment found = Align(recording);
    ASSERT_EQ(found.undetermined.size(), 1u);
    EXPECT_THAT(found.undetermined[0], StartsWith("lever along ("));
    EXPECT_THAT(found.undetermined[0], HasSubstr(" 1.00)"));
    EXPECT_TRUE(std::isinf(found.sigma[6]));
    EXPECT_NEAR(found.fixing.camera_from_body.translation.z(), 0.0, 0.002);
    EXPECT_NEAR(found.fixing.camera_from_body.translation.x(), 0.03, 0.005);
    EXPECT_NEAR(found.fixing.shift, 0.01, 0.002);
  }
}

// At constant velocity, a time shift does not change the path of the truth, and
// only the direction of the line constrains the body's rotation.
TEST(TruthAlignmentTest, OnALineAllButTwoTurnsAreOpen) {
  Recording recording;
  recording.path = Line;
  for (recording.seed = 1; recording.seed <= 5; ++recording.seed) {
    const TruthAlignment found = Align(recording);
    ASSERT_EQ(found.undetermined.size(), 3u);
    EXPECT_EQ(found.undetermined[0], "time shift");
    EXPECT_THAT(found.undetermined[1], StartsWith("rotation about ("));
    EXPECT_EQ(found.undetermined[2], "lever");
    EXPECT_NEAR(found.fixing.shift, 0.0, 0.01 * kOpenTolerance);
    EXPECT_TRUE(std::isinf(found.sigma[0]));
  }
}

TEST(TruthAlignmentTest, StandingStillDeterminesNothing) {
  Recording recording;
  recording.path = Still;
  recording.seconds = 300.0;
  recording.truth_share = 1.0;
  for (const double share : {1.0, 1e-3, 0.0}) {
    SCOPED_TRACE(share);
    recording.place_noise = 0.001 * share;
    recording.turn_noise = 0.001 * share;
    for (recording.seed = 1; recording.seed <= 2; ++recording.seed) {
      const TruthAlignment found = Align(recording);
      EXPECT_EQ(found.skipped, "");
      EXPECT_THAT(found.undetermined,
                  ElementsAre("time shift", "rotation", "lever"));
      EXPECT_EQ(AsVector(found.fixing).norm(), 0.0);
    }
  }
}

TEST(TruthAlignmentTest, SaysWhyThereIsNone) {
  Recording recording;
  recording.seconds = 1.0;
  EXPECT_THAT(Align(recording).skipped, HasSubstr("at least 30 are needed"));
  recording = Recording();
  recording.truth_rate = 15.0;
  EXPECT_THAT(Align(recording).skipped, HasSubstr("only 0 motions of 0.2 s"));
  recording = Recording();
  recording.frame_rate = 2.0;
  EXPECT_THAT(Align(recording).skipped, HasSubstr("0 motions"));
}

}  // namespace
}  // namespace rgbd_pose
