#include "frontend/tracking/inertial_tracking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/util/quantile.h"
#include "tests/support/shutter_sequence.h"
#include "tests/support/track_sequence.h"

namespace rgbd_pose {
namespace {

// A hand that sees nothing for half a second.
constexpr int kFrames = 80;
constexpr int kBlindFrom = 50, kBlindTo = 65;

// Rolling shutters and an inertial sensor.
struct HandWithImu {
  HandWithImu(const std::string& path, int frames,
              const Shutters& shutters = RollingShutters(1.0))
      : sequence(path, shutters, frames),
        samples(sequence.dataset.SimulateImu(Options())) {
    sensor.calibration.cam_from_imu = Options().cam_from_imu;
  }

  static SyntheticImuOptions Options() {
    SyntheticImuOptions options;
    options.cam_from_imu =
        Rigid3d::FromRotationVector({0.5, -1.0, 0.3}, {0.03, -0.02, 0.01});
    options.bias << 0.01, -0.01, 0.01, 0.1, -0.1, 0.1;
    return options;
  }

  static const HandWithImu& Get() {
    static const HandWithImu hand("handheld", kFrames);
    return hand;
  }

  ShutterSequence sequence;
  std::vector<ImuSample> samples;
  ImuSensor sensor;
};

bool IsBlind(int frame) { return frame >= kBlindFrom && frame < kBlindTo; }

Frame Covered(const Frame& frame) {
  Frame covered = Black(frame);
  covered.depth = cv::Mat(frame.depth.size(), CV_32FC1, cv::Scalar(0));
  return covered;
}

enum class Sensor { kNone, kGood, kSwapped };

struct TrackedHand {
  std::vector<TrackedFrame> frames;
  std::vector<std::optional<Twist>> twists;
};

TrackedHand TrackHandAgain(Sensor sensor, bool is_covered) {
  const HandWithImu& hand = HandWithImu::Get();
  Odometry odometry = OdometryFor(hand.sequence, "hybrid", ShutterUse::kCamera);
  if (sensor != Sensor::kNone) odometry.UseImu(hand.sensor);
  std::vector<ImuSample> samples = hand.samples;
  if (sensor == Sensor::kSwapped) {
    for (ImuSample& sample : samples) {
      std::swap(sample.gyro.x(), sample.gyro.z());
    }
  }
  odometry.AddImu(samples);
  TrackedHand run;
  for (int i = 0; i < kFrames; ++i) {
    const Frame& frame = hand.sequence.frames[i];
    const bool is_blind = is_covered && IsBlind(i);
    run.frames.push_back(odometry.Track(is_blind ? Covered(frame) : frame));
    run.twists.push_back(odometry.last_twist());
  }
  return run;
}

// Several tests look at the same run.
const TrackedHand& TrackHand(Sensor sensor, bool is_covered) {
  static std::map<std::pair<Sensor, bool>, TrackedHand> runs;
  auto run = runs.find({sensor, is_covered});
  if (run == runs.end()) {
    run = runs.emplace(std::pair(sensor, is_covered),
                       TrackHandAgain(sensor, is_covered))
              .first;
  }
  return run->second;
}

// Of the motion from one frame to another, m.
double ShiftError(const TrackedHand& run, int from, int to) {
  const Rigid3d motion =
      run.frames[to].world_from_cam.Inverse() * run.frames[from].world_from_cam;
  const Rigid3d truth = HandWithImu::Get().sequence.Motion(from, to);
  return (motion.Inverse().translation - truth.Inverse().translation).norm();
}

TEST(InertialTrackingTest, GoesOnWhereImagesShowNothing) {
  const TrackedHand& run = TrackHand(Sensor::kGood, true);
  for (int i = kBlindFrom; i < kBlindTo; ++i) {
    const TrackedFrame& frame = run.frames[i];
    EXPECT_EQ(frame.status, TrackingStatus::kDegraded) << i;
    EXPECT_EQ(frame.source, TrackingSource::kInertial) << i;
    EXPECT_EQ(frame.reason, "no image: inertial sensor only");
    ASSERT_EQ(frame.edges.size(), 1) << i;
    const Eigen::Matrix3d covariance =
        frame.edges[0].covariance.bottomRightCorner<3, 3>();
    EXPECT_LT(ShiftError(run, kBlindFrom - 1, i),
              4.0 * std::sqrt(covariance.trace()))
        << i;
  }
  EXPECT_LT(ShiftError(run, kBlindFrom - 1, kBlindTo - 1), 0.015);
  // It is found again from there, in the same world.
  for (int i = kBlindTo; i < kFrames; ++i) {
    EXPECT_EQ(run.frames[i].status, TrackingStatus::kOk) << i;
    EXPECT_EQ(run.frames[i].segment, 0) << i;
    EXPECT_LT(ShiftError(run, kBlindFrom - 1, i), 0.015) << i;
  }
}

// Images that a driver has sent again show no turn where the gyroscope has
// measured one.
TEST(InertialTrackingTest, LearnsNothingFromRepeatedImages) {
  constexpr int kNew = 6, kSent = 8;  // images
  const HandWithImu hand("handheld", kFrames, Shutters());
  for (const bool is_noticed : {false, true}) {
    Odometry odometry =
        OdometryFor(hand.sequence, "hybrid", ShutterUse::kCamera);
    odometry.UseImu(hand.sensor);
    odometry.AddImu(hand.samples);
    for (int i = 0; i < kFrames; ++i) {
      const int shown = i - std::max(0, i % kSent - kNew + 1);
      const bool is_repeated = shown < i;
      Frame frame = hand.sequence.frames[shown];
      if (!is_noticed) frame = TakenAgain(frame, i);
      frame.timestamp = hand.sequence.frames[i].timestamp;
      const TrackedFrame tracked = odometry.Track(frame);
      if (!is_repeated || !is_noticed) continue;
      EXPECT_EQ(tracked.status, TrackingStatus::kDegraded) << i;
      EXPECT_EQ(tracked.reason, "an image of it is that of the frame before")
          << i;
    }
    EXPECT_EQ(odometry.imu()->is_trusted(), is_noticed)
        << odometry.imu()->doubt();
  }
}

// Half a turn at 600 degrees/s, from 1.3 to 1.7 s, too fast for the images.
// Nothing of what the camera saw before is in view afterwards.
TEST(InertialTrackingTest, GoesOnFromTheNewViewAfterAQuickTurn) {
  constexpr int kTurnFrom = 40, kTurnTo = 51, kLast = 79;
  const HandWithImu hand("whip_pan_fast", kLast + 1);
  Odometry odometry = OdometryFor(hand.sequence, "hybrid", ShutterUse::kCamera);
  odometry.UseImu(hand.sensor);
  odometry.AddImu(hand.samples);
  TrackedFrame last;
  MotionMatrix turned;  // covariance of the last pose by the sensor alone
  int num_inertial = 0;
  for (int i = 0; i <= kLast; ++i) {
    const Frame& frame = hand.sequence.frames[i];
    const bool is_turning = i >= kTurnFrom && i < kTurnTo;
    last = odometry.Track(is_turning ? Covered(frame) : frame);
    if (last.source != TrackingSource::kInertial) continue;
    ++num_inertial;
    if (i > kTurnFrom && i < kTurnTo - 1) {
      EXPECT_EQ(last.reason,
                "too quick a turn for images: inertial sensor only");
    }
    turned = last.edges.at(0).covariance;
  }
  EXPECT_GE(num_inertial, kTurnTo - kTurnFrom);
  EXPECT_LE(num_inertial, kTurnTo - kTurnFrom + 3);
  EXPECT_EQ(last.status, TrackingStatus::kOk) << last.reason;
  EXPECT_EQ(last.segment, 0);
  const Rigid3d off = last.world_from_cam * hand.sequence.Motion(0, kLast);
  EXPECT_LT(off.translation.norm(), 0.03);
  EXPECT_LT(off.Angle(), 0.05);
  EXPECT_LT(off.Angle(), 4.0 * std::sqrt(turned.topLeftCorner<3, 3>().trace()));
}

TEST(InertialTrackingTest, WithoutASensorTheCameraIsLostThere) {
  const TrackedHand& run = TrackHand(Sensor::kNone, true);
  EXPECT_EQ(run.frames[kBlindFrom + 1].status, TrackingStatus::kLost);
}

// After a second, in which the sensor is tested.
constexpr int kFirst = 30;

TEST(InertialTrackingTest, KnowsTheVelocityOfEachFrame) {
  const HandWithImu& hand = HandWithImu::Get();
  struct MeanError {
    double angular = 0.0, linear = 0.0;
  };
  const auto mean_error = [&](const TrackedHand& run) {
    MeanError mean;
    for (int i = kFirst; i + 1 < kFrames; ++i) {
      // The rate of the path over the two intervals around the frame.
      const Twist truth = TwistOf(hand.sequence.Motion(i - 1, i + 1),
                                  hand.sequence.frames[i + 1].timestamp -
                                      hand.sequence.frames[i - 1].timestamp);
      const Twist error = run.twists[i].value() - truth;
      mean.angular += error.angular.norm() / (kFrames - 1 - kFirst);
      mean.linear += error.linear.norm() / (kFrames - 1 - kFirst);
    }
    return mean;
  };
  const MeanError without = mean_error(TrackHand(Sensor::kNone, false));
  const MeanError with = mean_error(TrackHand(Sensor::kGood, false));
  EXPECT_LT(with.angular, 0.4 * without.angular);
  EXPECT_LT(with.linear, 0.6 * without.linear);
}

// How the camera accelerates while its rows are exposed is most of what a
// rolling shutter leaves of the errors of motions.
TEST(InertialTrackingTest, MovesRowsByAccelerations) {
  const auto median_error = [&](Sensor sensor) {
    const TrackedHand& run = TrackHand(sensor, false);
    constexpr int kApart = 6;
    std::vector<double> errors;
    for (int i = kFirst; i + kApart < kFrames; ++i) {
      errors.push_back(ShiftError(run, i, i + kApart));
    }
    return Median(errors);
  };
  EXPECT_LT(median_error(Sensor::kGood), 0.6 * median_error(Sensor::kNone));
}

// The delay of the sensor that is found if colour is exposed so much later (s)
// than its camera file says.
double DelayFound(double exposed_later) {
  const HandWithImu& hand = HandWithImu::Get();
  Odometry odometry = OdometryFor(hand.sequence, "hybrid", ShutterUse::kCamera);
  odometry.UseImu(hand.sensor);
  odometry.AddImu(hand.samples);
  for (Frame frame : hand.sequence.frames) {
    frame.color_shutter.offset -= exposed_later;
    odometry.Track(frame);
  }
  EXPECT_TRUE(odometry.imu()->is_trusted()) << odometry.imu()->doubt();
  return odometry.imu()->Calibration().delay_s.value();
}

// A wrong time between colour and depth distorts the first result, not the
// second.
TEST(InertialTrackingTest, FindsWhenColourWasExposed) {
  constexpr double kLater = 0.010;  // s
  const double found = DelayFound(kLater);
  EXPECT_NEAR(found, kLater, 0.003);
  EXPECT_NEAR(found + DelayFound(kLater - found), kLater, 0.001);
}

// The path of a sensor with swapped axes is that without it, to the last bit.
TEST(InertialTrackingTest, ASensorThatContradictsTheImagesIsLeftOut) {
  const TrackedHand& with = TrackHand(Sensor::kSwapped, false);
  const TrackedHand& without = TrackHand(Sensor::kNone, false);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_EQ(with.frames[i].world_from_cam.translation,
              without.frames[i].world_from_cam.translation)
        << i;
  }
}

// Without a mounting nothing is known of the camera, and nothing is used.
TEST(InertialTrackingTest, ASensorWithoutMountingHasNoEffect) {
  const HandWithImu& hand = HandWithImu::Get();
  Odometry odometry = OdometryFor(hand.sequence, "hybrid", ShutterUse::kCamera);
  odometry.UseImu(ImuSensor());
  odometry.AddImu(hand.samples);
  EXPECT_EQ(odometry.imu(), nullptr);
}

}  // namespace
}  // namespace rgbd_pose
