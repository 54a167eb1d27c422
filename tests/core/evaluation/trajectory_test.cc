#include "core/evaluation/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST(TrajectoryTest, FormatsTumText) {
  const Quaterniond half_turn(0.0, 0.0, 1.0, 0.0);
  EXPECT_EQ(FormatTrajectory({{1305031098.6659, Rigid3d()},
                              {1305031099.0, {half_turn, {1.5, -2, 3e-10}}}}),
            "# timestamp tx ty tz qx qy qz qw\n"
            "1305031098.665900 0.000000000 0.000000000 0.000000000 "
            "0.000000000 0.000000000 0.000000000 1.000000000\n"
            "1305031099.000000 1.500000000 -2.000000000 0.000000000 "
            "0.000000000 1.000000000 0.000000000 0.000000000\n");
}

TEST(TrajectoryTest, ReadsWhatItWrites) {
  // Half of the last decimal; slightly more for a quaternion's four numbers.
  constexpr double kTimeTolerance = 0.51e-6;
  constexpr double kPositionTolerance = 0.51e-9;
  constexpr double kAngleTolerance = 2.1e-9;
  RandomWorld world(1);
  Trajectory written;
  for (int i = 0; i < 100; ++i) {
    written.push_back({1e9 + i + world.Uniform(0, 0.9), world.Motion(3.1, 50)});
  }
  const TempFolder folder;
  const Trajectory read =
      ReadTrajectory(folder.Write("t.txt", FormatTrajectory(written)));
  ASSERT_EQ(read.size(), written.size());
  for (size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].timestamp, written[i].timestamp, kTimeTolerance);
    const Rigid3d a = read[i].world_from_cam;
    const Rigid3d b = written[i].world_from_cam;
    EXPECT_LE((a.translation - b.translation).lpNorm<Eigen::Infinity>(),
              kPositionTolerance);
    EXPECT_LE((a.Inverse() * b).Angle(), kAngleTolerance);
  }
}

TEST(TrajectoryTest, ReadsTheColumnsInTheirOrder) {
  const TempFolder folder;
  const Trajectory read = ReadTrajectory(
      folder.Write("t.txt",
                   "\xEF\xBB\xBF# timestamp tx ty tz qx qy qz qw\r\n"
                   "\r\n"
                   "0.5 1 2 3 0 0 0.7071 0.7071 # a quarter turn about z\r\n"
                   "0.6,1,2,3,0,0,0,-1.009\r\n"));
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].timestamp, 0.5);
  const Vector3d in_world = read[0].world_from_cam * Vector3d(1, 0, 0);
  EXPECT_LE((in_world - Vector3d(1, 3, 3)).norm(), 1e-15);
  EXPECT_EQ(read[1].timestamp, 0.6);
  EXPECT_EQ(read[1].world_from_cam.rotation.norm(), 1.0);
}

TEST(TrajectoryTest, TakesTheFirstPoseOfATimeStamp) {
  const TempFolder folder;
  const std::string path = folder.Write(
      "t.txt", "1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n2.0 3 0 0 0 0 0 1\n");
  std::vector<std::string> remarks;
  const Trajectory read = ReadTrajectory(path, &remarks);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].world_from_cam.translation.x(), 2.0);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_EQ(remarks[0],
            path +
                ":3: has the same time stamp as the previous pose; 1 such pose "
                "is left out");
  EXPECT_EQ(ReadTrajectory(path).size(), 2u);
}

TEST(TrajectoryTest, NamesTheLineThatIsWrong) {
  const std::string good = "# comment\n1 0 0 0 0 0 0 1\n";  // lines 1 and 2
  const struct {
    const char* what;
    std::string content;
    const char* message;
  } kCases[] = {
      {"column missing", good + "2 0 0 0 0 0 1\n",
       ":3: 7 columns; a pose needs 8"},
      {"column too many", good + "2 0 0 0 0 0 0 1 5\n", ":3: 9 columns"},
      {"cut off", good + "2 0", ":3: 2 columns"},
      {"letters", good + "2 0 zero 0 0 0 0 1\n", ":3: 'zero' is no"},
      {"number and letters", good + "2 0 0m 0 0 0 0 1\n", ":3: '0m' is no"},
      {"NaN", good + "\n2 0 0 nan 0 0 0 1\n", ":4: 'nan' is no"},
      {"infinite", good + "2 inf 0 0 0 0 0 1\n", ":3: 'inf' is no"},
      {"too large", good + "2 0 0 1e999 0 0 0 1\n", ":3: '1e999' is no"},
      {"far away", good + "2 0 1e200 0 0 0 0 1\n",
       ":3: the position (columns 2 to 4) is more than 1e9 m away"},
      {"nanoseconds", good + "1305031102175304000 0 0 0 0 0 0 1\n",
       ":3: time stamp 1305031102175304000 is not in seconds"},
      {"time stamp NaN", "nan 0 0 0 0 0 0 1\n", ":1: 'nan' is no"},
      {"time backwards", good + "0.5 0 0 0 0 0 0 1\n",
       ":3: time stamp 0.5 is earlier than the previous one"},
      {"zero quaternion", good + "2 0 0 0 0 0 0 0\n",
       ":3: the quaternion (columns 5 to 8, qx qy qz qw) is not"},
      {"quaternion too long", good + "2 0 0 0 0 0 0 1.011\n", ":3: the qua"},
      {"quaternion too short", good + "2 0 0 0 0 0 0 0.989\n", ":3: the qua"},
      {"empty", "", ": contains no poses"},
      {"comments only", "# a\n\n# b\n", ": contains no poses"},
  };
  const TempFolder folder;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.what);
    const std::string file = folder.Write("t.txt", c.content);
    ExpectInputError([&] { ReadTrajectory(file); }, {file + c.message});
  }
  ExpectInputError([&] { ReadTrajectory(folder / "missing.txt"); },
                   {folder / "missing.txt"});
}

constexpr double kPathTolerance = 1e-12;  // rounding

Rigid3d TurnedAndMoved(double angle, double distance) {
  return {Quaterniond(AngleAxisd(angle, Vector3d::UnitY())),
          Vector3d(distance, 0, 0)};
}

TEST(InterpolatedPoseTest, GoesAlongLineAndArc) {
  Rigid3d other_sign = TurnedAndMoved(0.4, 2.0);
  other_sign.rotation.coeffs() *= -1.0;
  const Trajectory truth = {{1.00, TurnedAndMoved(0.0, 1.0)},
                            {1.04, other_sign}};
  const std::optional<Rigid3d> pose = InterpolatedPose(truth, 1.01);
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR((pose->Inverse() * TurnedAndMoved(0.1, 1.25)).Angle(), 0.0,
              kPathTolerance);
  EXPECT_NEAR(pose->translation.x(), 1.25, kPathTolerance);
}

TEST(InterpolatedPoseTest, CrossesNoGapsAndDoesNotLeave) {
  const Trajectory truth = {{0.0, TurnedAndMoved(0.0, 1.0)},
                            {0.06, TurnedAndMoved(0.0, 2.0)},
                            {0.08, TurnedAndMoved(0.0, 3.0)}};
  EXPECT_FALSE(InterpolatedPose(truth, -0.001).has_value());
  EXPECT_TRUE(InterpolatedPose(truth, 0.0).has_value());
  EXPECT_FALSE(InterpolatedPose(truth, 0.03).has_value());
  EXPECT_EQ(InterpolatedPose(truth, 0.06)->translation.x(), 2.0);
  EXPECT_NEAR(InterpolatedPose(truth, 0.07)->translation.x(), 2.5,
              kPathTolerance);
  EXPECT_EQ(InterpolatedPose(truth, 0.08)->translation.x(), 3.0);
  EXPECT_FALSE(InterpolatedPose(truth, 0.081).has_value());
}

Rigid3d YawedAt(double yaw, double x) {
  return Rigid3d(Quaterniond(AngleAxisd(yaw, Vector3d::UnitY())),
                 {x, 0.0, 0.0});
}

// A quarter turn in 0.1 s while moving 1 m along x; then a gap.
const Trajectory kGuess = {{10.0, YawedAt(0.0, 0.0)},
                           {10.1, YawedAt(M_PI / 2, 1.0)},
                           {11.0, YawedAt(0.0, 5.0)}};

TEST(TrajectoryMotionTest, IsTheMotionFromPreviousToCurrent) {
  const auto motion = MotionAlong(kGuess, 10.0, 10.1);
  ASSERT_TRUE(motion.has_value());
  // The current camera's z axis is the world's x axis; hence the previous
  // camera is 1 m behind it.
  const Rigid3d expected = YawedAt(M_PI / 2, 1.0).Inverse();
  EXPECT_LE((motion->translation - expected.translation).norm(), 1e-12);
  EXPECT_NEAR(motion->translation.z(), -1.0, 1e-12);
  EXPECT_NEAR(motion->Angle(), M_PI / 2, 1e-12);
}

TEST(TrajectoryMotionTest, InterpolatesBetweenPoses) {
  const auto motion = MotionAlong(kGuess, 10.0, 10.05);
  ASSERT_TRUE(motion.has_value());
  EXPECT_NEAR(motion->Angle(), M_PI / 4, 1e-9);
  EXPECT_NEAR(motion->Inverse().translation.x(), 0.5, 1e-9);
}

TEST(TrajectoryMotionTest, KnowsNothingInGapsAndBeyondTheEnds) {
  EXPECT_FALSE(MotionAlong(kGuess, 10.05, 10.5).has_value());
  EXPECT_FALSE(MotionAlong(kGuess, 9.9, 10.05).has_value());
  EXPECT_FALSE(MotionAlong(kGuess, 11.0, 11.1).has_value());
  EXPECT_TRUE(MotionAlong(kGuess, 9.99, 10.05).has_value());
  EXPECT_FALSE(MotionAlong(Trajectory(), 0.0, 0.1).has_value());
}

}  // namespace
}  // namespace rgbd_pose
