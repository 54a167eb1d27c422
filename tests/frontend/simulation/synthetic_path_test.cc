#include "frontend/simulation/synthetic_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/util/units.h"
#include "frontend/simulation/synthetic_scene.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

constexpr double kRate = 30.0;  // Hz

struct Extent {
  double max_speed = 0.0;                         // m/s
  double max_turn_rate = 0.0;                     // rad/s
  double max_angle = 0.0;                         // rad, from the start
  Eigen::Vector3d min = Eigen::Vector3d::Zero();  // of the camera's centre,
  Eigen::Vector3d max = Eigen::Vector3d::Zero();  // in axes of the first camera
};

Extent Measure(const std::string& name, int frames) {
  const SyntheticPath path = FindSyntheticPath(name);
  const double duration = (frames - 1) / kRate;
  const Rigid3d start = path(0.0, duration);
  Rigid3d last = start;
  Extent extent;
  for (int i = 1; i < frames; ++i) {
    const Rigid3d pose = path(i / kRate, duration);
    const Rigid3d step = last.Inverse() * pose;
    const Rigid3d start_from_cam = start.Inverse() * pose;
    extent.max_speed =
        std::max(extent.max_speed, step.translation.norm() * kRate);
    extent.max_turn_rate = std::max(extent.max_turn_rate, step.Angle() * kRate);
    extent.max_angle = std::max(extent.max_angle, start_from_cam.Angle());
    extent.min = extent.min.cwiseMin(start_from_cam.translation);
    extent.max = extent.max.cwiseMax(start_from_cam.translation);
    last = pose;
  }
  return extent;
}

TEST(SyntheticPathTest, XyzMovesAlongEachAxisBothWaysByHand) {
  const Extent extent = Measure("xyz", 301);  // two rounds
  constexpr double kTolerance = 2e-3;  // the peak may fall between two frames
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(extent.min[axis], -0.2, kTolerance);
    EXPECT_NEAR(extent.max[axis], 0.2, kTolerance);
  }
  EXPECT_LT(extent.max_speed, 0.4);
  EXPECT_LT(extent.max_angle, 3.0 * kRadiansPerDegree);
}

TEST(SyntheticPathTest, XyzShowsAllAxesInTheDefaultLength) {
  const Extent extent = Measure("xyz", 150);
  EXPECT_GT(extent.max.minCoeff(), 0.19);
}

TEST(SyntheticPathTest, PanTiltReturnsExactlyForAnyNumberOfFrames) {
  const SyntheticPath path = FindSyntheticPath("pan_tilt");
  for (const int frames : {1, 2, 7, 30, 100, 150, 151, 299, 1000}) {
    const double duration = (frames - 1) / kRate;
    const Rigid3d first = path(0.0, duration);
    const Rigid3d last = path((frames - 1) / kRate, duration);
    EXPECT_EQ(first.rotation.coeffs(), last.rotation.coeffs()) << frames;
    EXPECT_EQ(first.translation, last.translation) << frames;
  }
}

TEST(SyntheticPathTest, PanTiltTurnsAsAUnitWithTheCameraOffItsAxes) {
  const Extent extent = Measure("pan_tilt", 150);
  EXPECT_NEAR(extent.max_angle, 20.0 * kRadiansPerDegree,
              0.1 * kRadiansPerDegree);
  EXPECT_LT(extent.max_turn_rate, 40.0 * kRadiansPerDegree);
  const double reach = (extent.max - extent.min).maxCoeff();
  EXPECT_GT(reach, 0.01);
  EXPECT_LT(reach, 0.08);
}

TEST(SyntheticPathTest, CircleIsLevelAndClosed) {
  const SyntheticPath path = FindSyntheticPath("circle");
  const Eigen::Vector3d start = path(0.0, 9.0).translation;
  const Eigen::Vector3d opposite = path(4.5, 9.0).translation;
  constexpr double kTolerance = 1e-12;  // rounding
  EXPECT_NEAR((opposite - start).norm(), 0.6, kTolerance);
  EXPECT_NEAR((path(9.0, 9.0).translation - start).norm(), 0.0, kTolerance);
  EXPECT_EQ(path(2.0, 9.0).translation.z(), start.z());
}

struct Peaks {
  double speed = 0.0;                                     // m/s
  double turn_rate = 0.0;                                 // rad/s
  double change_of_speed = 0.0;                           // m/s^2
  double clearance = std::numeric_limits<double>::max();  // m
};

// Distance of a point from a rectangle.
double Distance(const SceneFace& face, const Eigen::Vector3d& point) {
  const Eigen::Vector3d from_origin = point - face.origin;
  const double u = face.u_axis.dot(from_origin);
  const double v = face.v_axis.dot(from_origin);
  return std::hypot(u - std::clamp(u, 0.0, face.width),
                    v - std::clamp(v, 0.0, face.height),
                    face.normal.dot(from_origin));
}

// By differences over 0.1 ms, by default every 5 ms.
Peaks FindPeaks(const std::string& name, double seconds,
                const std::string& scene = "room", double every = 0.005) {
  const SyntheticPath path = FindSyntheticPath(name);
  const Scene room = MakeScene(scene, 1);
  constexpr double kStep = 1e-4;  // s
  Peaks peaks;
  for (double t = 0.0; t < seconds; t += every) {
    const Rigid3d before = path(t - kStep, seconds);
    const Rigid3d now = path(t, seconds);
    const Rigid3d after = path(t + kStep, seconds);
    const Eigen::Vector3d way = after.translation - before.translation;
    const double turn = (before.Inverse() * after).Angle();
    const Eigen::Vector3d bend =
        after.translation - 2.0 * now.translation + before.translation;
    peaks.speed = std::max(peaks.speed, way.norm() / (2.0 * kStep));
    peaks.turn_rate = std::max(peaks.turn_rate, turn / (2.0 * kStep));
    peaks.change_of_speed =
        std::max(peaks.change_of_speed, bend.norm() / (kStep * kStep));
    for (const SceneFace& face : room.faces) {
      peaks.clearance =
          std::min(peaks.clearance, Distance(face, now.translation));
    }
  }
  return peaks;
}

TEST(SyntheticPathTest, HandheldIsFastButKeepsItsLimits) {
  const Peaks always = FindPeaks("handheld", 100.0);  // then the path repeats
  EXPECT_LE(always.speed, 1.0);
  EXPECT_LE(always.turn_rate, 90.0 * kRadiansPerDegree);
  EXPECT_GE(always.clearance, 0.6);
  EXPECT_LE(always.change_of_speed, 10.0);  // as an arm can move
  const Peaks default_length = FindPeaks("handheld", 149 / kRate);
  EXPECT_GE(default_length.speed, 0.95);
  EXPECT_GE(default_length.turn_rate, 85.0 * kRadiansPerDegree);
}

TEST(SyntheticPathTest, WhipPansTurnHalfRoundAndBack) {
  const SyntheticPath path = FindSyntheticPath("whip_pan");
  const SyntheticPath xyz = FindSyntheticPath("xyz");
  const auto turned = [&](double t) {
    return (path(t, 10.0).rotation * xyz(t, 10.0).rotation.conjugate())
        .angularDistance(Eigen::Quaterniond::Identity());
  };
  constexpr double kTolerance = 1e-9;
  for (const double t : {0.0, 1.15, 4.85, 7.0}) {
    EXPECT_NEAR(turned(t), 0.0, kTolerance) << t;
  }
  for (const double t : {1.85, 3.0, 4.15}) {
    EXPECT_NEAR(turned(t), M_PI, kTolerance) << t;
  }
  // Half a second at full speed.
  EXPECT_NEAR(turned(1.75) - turned(1.25), 150.0 * kRadiansPerDegree,
              kTolerance);
  const Peaks peaks = FindPeaks("whip_pan", 10.0);
  EXPECT_NEAR(peaks.turn_rate, 300.0 * kRadiansPerDegree, 0.1);
  EXPECT_LT(peaks.speed, 0.4);  // its centre moves like path xyz
}

TEST(SyntheticPathTest, FastWhipPansTurnAsFarInLessTime) {
  const SyntheticPath path = FindSyntheticPath("whip_pan_fast");
  EXPECT_NEAR(
      path(1.3, 10.0).rotation.angularDistance(path(1.7, 10.0).rotation), M_PI,
      0.1);
  EXPECT_NEAR(FindPeaks("whip_pan_fast", 10.0).turn_rate,
              600.0 * kRadiansPerDegree, 0.1);
}

struct Tour {
  const char* name;
  double seconds;  // until the camera is back at its start
  double length;   // m
  double speed;    // m/s at most
};

class SyntheticTours : public testing::TestWithParam<Tour> {};

TEST_P(SyntheticTours, AreCarriedByHandAndReturn) {
  const Tour tour = GetParam();
  const Peaks peaks =
      FindPeaks(tour.name, tour.seconds, tour.name, tour.seconds / 1000.0);
  EXPECT_LE(peaks.speed, tour.speed);
  EXPECT_LE(peaks.turn_rate, 40.0 * kRadiansPerDegree);
  EXPECT_LE(peaks.change_of_speed, 2.0);
  EXPECT_GE(peaks.clearance, 0.4);
  const SyntheticPath path = FindSyntheticPath(tour.name);
  double way = 0.0;
  for (double t = 0.0; t < tour.seconds; t += 0.5) {
    way += (path(t + 0.5, 1.0).translation - path(t, 1.0).translation).norm();
  }
  EXPECT_NEAR(way, tour.length, 1.0);
  // Back at the start, except for the sway of the hand.
  const Rigid3d back = path(0.0, 1.0).Inverse() * path(tour.seconds, 1.0);
  EXPECT_LT(back.translation.norm(), 0.06);
  EXPECT_LT(back.Angle(), 5.0 * kRadiansPerDegree);
}

INSTANTIATE_TEST_SUITE_P(Tours, SyntheticTours,
                         testing::Values(Tour{"table", 56.0, 19.0, 0.5},
                                         Tour{"two_rooms", 57.0, 22.0, 0.5},
                                         Tour{"twin_corridors", 110.0, 36.0,
                                              0.6}));

TEST(SyntheticPathTest, UnknownNameListsTheNames) {
  ExpectInputError(
      [] { FindSyntheticPath("spiral"); },
      {"spiral",
       "xyz, pan_tilt, circle, still, walk, handheld, whip_pan, whip_pan_fast, "
       "table, two_rooms, twin_corridors"});
}

}  // namespace
}  // namespace rgbd_pose
