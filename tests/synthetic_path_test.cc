#include "frontend/synthetic_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/input_error.h"

namespace rgbd_pose {
namespace {

constexpr double kRate = 30.0;  // Hz
constexpr double kDegree = M_PI / 180.0;

struct Extent {
  double max_speed = 0.0;                         // m/s
  double max_turn_rate = 0.0;                     // rad/s
  double max_angle = 0.0;                         // rad, from the start
  Eigen::Vector3d min = Eigen::Vector3d::Zero();  // of the camera's centre, in
  Eigen::Vector3d max = Eigen::Vector3d::Zero();  // axes of the first camera
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
  EXPECT_LT(extent.max_angle, 3.0 * kDegree);
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
  EXPECT_NEAR(extent.max_angle, 20.0 * kDegree, 0.1 * kDegree);
  EXPECT_LT(extent.max_turn_rate, 40.0 * kDegree);
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

TEST(SyntheticPathTest, StillIsStill) {
  const Extent extent = Measure("still", 100);
  EXPECT_EQ(extent.max_speed, 0.0);
  EXPECT_EQ(extent.max_turn_rate, 0.0);
}

TEST(SyntheticPathTest, UnknownNameListsTheNames) {
  try {
    FindSyntheticPath("spiral");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("spiral"));
    EXPECT_THAT(error.what(),
                testing::HasSubstr("xyz, pan_tilt, circle, still"));
  }
}

}  // namespace
}  // namespace rgbd_pose
