#include "frontend/slam/keyframe_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/graph_world.h"
#include "tests/support/motion_error.h"
#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

constexpr int kPoses = 40;

// A certain motion of half a metre.
RelativePose Step(int ref, int cur) {
  return {ref, cur, Moved(0.5, 0.0, 0.0), 1e-6 * MotionMatrix::Identity()};
}

// One round on a circle, as measured by odometry.
struct Circle {
  explicit Circle(unsigned seed = 1)
      : world(seed), truth(CircleOfPoses(kPoses, 3.0)), graph(10, 0.01) {
    graph.Add(truth[0], 0);
    for (int i = 1; i < kPoses; ++i) {
      const RelativePose edge = Measured(i - 1, i);
      graph.Add(graph.pose(i - 1) * edge.cur_from_ref.Inverse(), 0);
      graph.AddPair(edge, /*is_tracked=*/true);
    }
  }

  RelativePose Measured(int ref, int cur) {
    return MeasuredEdge(truth, ref, cur, 0.001, 0.002, &world);
  }
  double LastError() const {
    return ErrorOf(graph.pose(kPoses - 1), truth[kPoses - 1]).translation;
  }

  RandomWorld world;
  std::vector<Rigid3d> truth;
  KeyframeGraph graph;
};

TEST(KeyframeGraphTest, ALoopTakesDriftBack) {
  Circle circle;
  const double drift = circle.LastError();
  ASSERT_GT(drift, 0.02);
  const RelativePose loop = circle.Measured(0, kPoses - 1);
  EXPECT_TRUE(circle.graph.PassesMahalanobisGate(loop));
  circle.graph.AddPair(loop, /*is_tracked=*/false, /*is_loop=*/true);
  EXPECT_EQ(circle.graph.SolveAll(), "");
  EXPECT_LT(circle.LastError(), 0.3 * drift);
}

// Angle (rad) between the y axes of the world as two poses have it.
double TiltBetween(const Rigid3d& a, const Rigid3d& b) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  return std::acos(std::min(
      1.0, (a.rotation.conjugate() * y).dot(b.rotation.conjugate() * y)));
}

// The axis of the circle is up. One of the keyframes measures nonsense.
TEST(KeyframeGraphTest, GravityHoldsTheTilt) {
  Circle drifted, held;
  RandomWorld random(7);
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::Vector3d error(random.Normal(0.001), random.Normal(0.001),
                                random.Normal(0.001));
    const Eigen::Vector3d up =
        held.truth[i].rotation.conjugate() * Eigen::Vector3d::UnitY() + error;
    held.graph.SetUp(i, {i == 20 ? -up.normalized() : up.normalized(), 0.001});
  }
  ASSERT_EQ(drifted.graph.SolveAll(), "");
  ASSERT_EQ(held.graph.SolveAll(), "");
  double before = 0.0, after = 0.0;
  for (int i = 0; i < kPoses; ++i) {
    before += TiltBetween(drifted.graph.pose(i), drifted.truth[i]) / kPoses;
    after += TiltBetween(held.graph.pose(i), held.truth[i]) / kPoses;
  }
  EXPECT_GT(before, 0.002);
  EXPECT_LT(after, 0.6 * before);
  EXPECT_EQ(held.graph.pose(0), held.truth[0]);
  EXPECT_EQ(held.graph.Covariances().size(), kPoses);
  // It is known better, too.
  EXPECT_LT(held.graph.Covariances().back()(0, 0),
            0.2 * drifted.graph.Covariances().back()(0, 0));
}

// Those that stay where they are say how the world lies.
TEST(KeyframeGraphTest, GravityHoldsTheTiltOfTheNewest) {
  Circle drifted, held;
  for (int i = 0; i < kPoses; ++i) {
    held.graph.SetUp(
        i, {held.truth[i].rotation.conjugate() * Eigen::Vector3d::UnitY(),
            i < kPoses / 2 ? 0.0001 : 0.001});
  }
  ASSERT_EQ(drifted.graph.SolveNear(kPoses - 1), "");
  ASSERT_EQ(held.graph.SolveNear(kPoses - 1), "");
  EXPECT_NE(held.graph.pose(kPoses - 1).rotation.coeffs(),
            drifted.graph.pose(kPoses - 1).rotation.coeffs());
  EXPECT_EQ(held.graph.pose(5), drifted.graph.pose(5));
}

TEST(KeyframeGraphTest, AllWorldsAreMovedTogether) {
  Circle circle;
  circle.graph.Add(circle.truth[3], 7);
  const Rigid3d moved =
      Rigid3d::FromRotationVector({1.0, 0.2, -0.3}, {1, 2, 3});
  const Rigid3d motion = circle.graph.CurFromRef(4, 30);
  circle.graph.MoveAll(moved);
  EXPECT_EQ(circle.graph.pose(0), moved * circle.truth[0]);
  EXPECT_EQ(circle.graph.pose(kPoses), moved * circle.truth[3]);
  EXPECT_LT(ErrorOf(circle.graph.CurFromRef(4, 30), motion).translation, 1e-12);
}

TEST(KeyframeGraphTest, AllThatTheNewestIsPairedWithAreFreedNearIt) {
  Circle circle;
  const std::vector<int> old = {2, 5, 9, 7};
  std::vector<Eigen::Vector3d> before;
  for (const int at : old) {
    before.push_back(circle.graph.pose(at).translation);
    circle.graph.AddPair(circle.Measured(at, kPoses - 1), false, true);
  }
  ASSERT_EQ(circle.graph.SolveNear(kPoses - 1), "");
  for (size_t i = 0; i < old.size(); ++i) {
    EXPECT_NE(circle.graph.pose(old[i]).translation, before[i]) << old[i];
  }
}

// Some poses have no edge, others only an edge with an unknown motion.
TEST(KeyframeGraphTest, WhatHangsLooselyDoesNotKeepOthersFromBeingSolvedFor) {
  for (const bool is_linked : {false, true}) {
    Circle circle;
    const double drift = circle.LastError();
    circle.graph.AddPair(circle.Measured(0, kPoses - 1), false, true);
    const int loose = circle.graph.Add(Rigid3d(), 0);
    const RelativePose step = Step(loose, circle.graph.Add(Rigid3d(), 0));
    circle.graph.AddPair(step, /*is_tracked=*/true);
    if (is_linked) {
      const MotionMatrix unknown = 4.0 * MotionMatrix::Identity();
      circle.graph.AddPair({kPoses - 1, loose, {}, unknown}, true);
    }
    EXPECT_EQ(circle.graph.SolveAll(), "");
    EXPECT_LT(circle.LastError(), 0.3 * drift);
    EXPECT_EQ(circle.graph.SolveNear(step.cur), "");
    EXPECT_NEAR((circle.graph.pose(loose).translation -
                 circle.graph.pose(step.cur).translation)
                    .norm(),
                0.5, 1e-6);
    EXPECT_EQ(circle.graph.Covariances().empty(), false);
  }
}

// A place with the same appearance, 5 m from the current pose.
TEST(KeyframeGraphTest, ALoopThatThePathForbidsIsNotPlausible) {
  Circle circle;
  RelativePose twin = circle.Measured(0, kPoses - 1);
  twin.cur_from_ref.translation.x() += 5.0;
  EXPECT_FALSE(circle.graph.PassesMahalanobisGate(twin));
  // For near keyframes, an error of some centimetres is too much.
  RelativePose near = circle.Measured(0, 2);
  EXPECT_TRUE(circle.graph.PassesMahalanobisGate(near));
  near.cur_from_ref.translation.x() += 0.1;
  EXPECT_FALSE(circle.graph.PassesMahalanobisGate(near));
}

TEST(KeyframeGraphTest, ASegmentMovesAsAWholeWhereItIsJoined) {
  Circle circle;
  const int first = circle.graph.Add(Rigid3d(), 7);
  const int second = circle.graph.Add(Rigid3d(), 7);
  const RelativePose step = Step(first, second);
  circle.graph.AddPair(step, /*is_tracked=*/true);
  EXPECT_FALSE(
      circle.graph.PassesMahalanobisGate({3, second, {}, step.covariance}));
  RelativePose met = Step(5, second);
  met.cur_from_ref = circle.world.Motion(1.0, 1.0);
  const Rigid3d before =
      circle.graph.pose(first).Inverse() * circle.graph.pose(second);
  circle.graph.Join(met);
  EXPECT_EQ(circle.graph.segment(first), 0);
  EXPECT_EQ(circle.graph.segment(second), 0);
  const Rigid3d after =
      circle.graph.pose(first).Inverse() * circle.graph.pose(second);
  EXPECT_LT(ErrorOf(before, after).translation, 1e-12);
  EXPECT_LT(ErrorOf(circle.graph.pose(5) * met.cur_from_ref.Inverse(),
                    circle.graph.pose(second))
                .translation,
            1e-12);
}

// Holds for both directions of the edge.
TEST(KeyframeGraphTest, ASegmentThatIsHeldIsNeverMovedToAnother) {
  for (const bool to_held : {false, true}) {
    RandomWorld world(3);
    const Rigid3d place = world.Motion(1.0, 1.0);
    KeyframeGraph graph(10, 0.01);
    const int held = graph.Add(place, 0, /*is_held=*/true);
    const int own = graph.Add(world.Motion(1.0, 1.0), 1);
    const int other = graph.Add(Rigid3d(), 2, /*is_held=*/true);
    RelativePose met;
    met.ref = to_held ? own : held;
    met.cur = to_held ? held : own;
    met.cur_from_ref = world.Motion(1.0, 1.0);
    EXPECT_TRUE(graph.Join(met));
    EXPECT_EQ(graph.pose(held).translation, place.translation);
    EXPECT_EQ(graph.segment(held), 0);
    EXPECT_EQ(graph.segment(own), 0);
    const Rigid3d between = graph.pose(met.cur).Inverse() * graph.pose(met.ref);
    EXPECT_LT(ErrorOf(between, met.cur_from_ref).translation, 1e-12);
    // Of two held segments, neither can be moved.
    met.ref = other;
    met.cur = own;
    EXPECT_FALSE(graph.Join(met));
    EXPECT_EQ(graph.pose(held).translation, place.translation);
    EXPECT_EQ(graph.segment(other), 2);
  }
}

TEST(KeyframeGraphTest, WhatIsDroppedStaysWhereItWasToItsAnchor) {
  Circle circle;
  EXPECT_FALSE(circle.graph.IsRedundant(0));   // the first one is kept
  EXPECT_FALSE(circle.graph.IsRedundant(10));  // it connects the chain
  circle.graph.AddPair(circle.Measured(9, 11), /*is_tracked=*/false);
  ASSERT_TRUE(circle.graph.IsRedundant(10));
  const Rigid3d before = circle.graph.pose(9).Inverse() * circle.graph.pose(10);
  circle.graph.Remove(10, 9);
  EXPECT_TRUE(circle.graph.IsRemoved(10));
  for (const MapEdge& pair : circle.graph.pairs()) {
    EXPECT_TRUE(pair.ref != 10 && pair.cur != 10);
  }
  circle.graph.AddPair(circle.Measured(0, kPoses - 1), false, true);
  ASSERT_EQ(circle.graph.SolveAll(), "");
  const Rigid3d after = circle.graph.pose(9).Inverse() * circle.graph.pose(10);
  EXPECT_LT(ErrorOf(before, after).translation, 1e-9);

  // A motion measured to a removed keyframe is converted to its anchor.
  const RelativePose edge = circle.Measured(10, 12);
  const RelativePose anchored = circle.graph.Reanchor(edge);
  EXPECT_EQ(anchored.ref, 9);
  EXPECT_LT(ErrorOf(anchored.cur_from_ref,
                    circle.truth[12].Inverse() * circle.truth[9])
                .translation,
            0.05);
  EXPECT_GT(anchored.covariance.trace(), edge.covariance.trace());
}

// Edges of a loaded map may lead to earlier keyframes. The errors of such a
// motion follow from those of its inverse by finite differences.
TEST(KeyframeGraphTest, MotionsToAnAnchorAreAsCertainInEitherDirection) {
  const Rigid3d cur_from_ref =
      Rigid3d::FromRotationVector({0.3, -1.2, 0.1}, {1.0, 0.5, -2.0});
  const Rigid3d ref_from_cur = cur_from_ref.Inverse();
  constexpr double kStep = 1e-6;
  MotionMatrix by_motion;
  for (int i = 0; i < 6; ++i) {
    const MotionVector e = kStep * MotionVector::Unit(i);
    const Eigen::Quaterniond turned =
        Rigid3d::FromRotationVector(e.head<3>(), {0, 0, 0}).rotation *
        cur_from_ref.rotation;
    const Rigid3d moved =
        Rigid3d(turned.conjugate(), ref_from_cur.translation + e.tail<3>());
    by_motion.col(i) << RotationVector(moved.rotation * cur_from_ref.rotation),
        moved.Inverse().translation - cur_from_ref.translation;
  }
  by_motion /= kStep;
  MotionMatrix covariance = 1e-4 * MotionMatrix::Identity();
  covariance(3, 3) = 1e-2;
  covariance(0, 4) = covariance(4, 0) = 5e-5;
  const MotionMatrix of_inverse =
      by_motion * covariance * by_motion.transpose();
  MotionMatrix expected;
  for (const RelativePose& pair :
       {RelativePose{0, 1, cur_from_ref, covariance},
        RelativePose{1, 0, ref_from_cur, of_inverse}}) {
    KeyframeGraph graph(10, 0.01);
    graph.Add(Rigid3d(), 0);
    graph.Add(ref_from_cur, 0);
    graph.AddPair(pair, /*is_tracked=*/false);
    graph.Remove(1, 0);
    const MotionMatrix actual = graph.Reanchor(Step(1, 2)).covariance;
    if (pair.ref == 0) expected = actual;
    EXPECT_TRUE(actual.isApprox(expected, 1e-5)) << actual << "\n" << expected;
  }
}

TEST(KeyframeGraphTest, WhatIsHeldNeverMoves) {
  Circle circle;
  KeyframeGraph graph(10, 0.01);
  for (int i = 0; i < 3; ++i) {
    graph.Add(circle.truth[i], 0, /*is_held=*/true);
  }
  const int newest = graph.Add(circle.truth[3], 0);
  for (int i = 0; i < 3; ++i) graph.AddPair(circle.Measured(i, newest), false);
  graph.AddPair(circle.Measured(0, 1), false);
  ASSERT_EQ(graph.SolveAll(), "");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(graph.pose(i).translation, circle.truth[i].translation);
    EXPECT_FALSE(graph.IsRedundant(i));
  }
  EXPECT_LT(ErrorOf(graph.pose(newest), circle.truth[3]).translation, 0.02);
}

// Includes wrong pairs: least squares without losses must find the same poses.
TEST(KeyframeGraphTest, CovariancesAsSolvedLetOthersFindTheSame) {
  Circle circle;
  for (int i = 0; i + 7 < kPoses; ++i) {
    RelativePose edge = circle.Measured(i, i + 7);
    if (i % 5 == 0) edge.cur_from_ref.translation.x() += 0.05;
    circle.graph.AddPair(edge, /*is_tracked=*/false);
  }
  ASSERT_EQ(circle.graph.SolveAll(), "");
  PoseGraph as_solved, as_measured;
  for (int i = 0; i < kPoses; ++i) {
    as_solved.AddPose(circle.graph.pose(i), i == 0);
    as_measured.AddPose(circle.graph.pose(i), i == 0);
  }
  for (const MapEdge& pair : circle.graph.pairs()) {
    RelativePose edge = pair;
    as_measured.AddEdge(edge);
    edge.covariance = circle.graph.CovarianceAsSolved(pair);
    as_solved.AddEdge(edge);
  }
  ASSERT_TRUE(as_solved.Solve().ok());
  ASSERT_TRUE(as_measured.Solve().ok());
  double moved = 0.0, moved_as_measured = 0.0;
  for (int i = 0; i < kPoses; ++i) {
    const Rigid3d& pose = circle.graph.pose(i);
    moved = std::max(moved, ErrorOf(as_solved.pose(i), pose).translation);
    moved_as_measured = std::max(
        moved_as_measured, ErrorOf(as_measured.pose(i), pose).translation);
  }
  EXPECT_LT(moved, 1e-4);
  EXPECT_GT(moved_as_measured, 1e-3);
}

// Two pairs of the same keyframes contradict each other by 3 mm.
TEST(KeyframeGraphTest, APairOfTheOdometryCountsTwice) {
  KeyframeGraph graph(10, 0.01);
  RelativePose edge = {graph.Add({}, 0), graph.Add({}, 0), {}, {}};
  edge.covariance = 1e-4 * MotionMatrix::Identity();
  graph.AddPair(edge, /*is_tracked=*/true);
  edge.cur_from_ref.translation.x() = 0.003;
  graph.AddPair(edge, /*is_tracked=*/false);
  ASSERT_EQ(graph.SolveAll(), "");
  EXPECT_NEAR(graph.pose(edge.cur).translation.norm(), 0.001, 1e-4);
}

// Rotations are wrong by 5 %, far more than their covariances allow.
TEST(KeyframeGraphTest, SlackIsTheShareThatMotionsAreOffBy) {
  for (const double wrong : {1e-9, 0.05}) {
    Circle circle;
    KeyframeGraph graph(10, 0.01);
    for (const Rigid3d& pose : circle.truth) graph.Add(pose, 0);
    for (int step : {1, 3, 5}) {
      for (int i = 0; i < kPoses; ++i) {
        RelativePose edge = circle.Measured(i, (i + step) % kPoses);
        const Eigen::AngleAxisd turn(edge.cur_from_ref.rotation);
        edge.cur_from_ref.rotation = Eigen::AngleAxisd(
            (1.0 + circle.world.Normal(wrong)) * turn.angle(), turn.axis());
        graph.AddPair(edge, false);
      }
    }
    ASSERT_EQ(graph.SolveAll(), "");
    if (wrong < 0.01) {
      EXPECT_LT(graph.proportional_error(), 0.003);
    } else {
      EXPECT_GT(graph.proportional_error(),
                0.004);  // one of six directions is wrong
      EXPECT_LT(graph.proportional_error(), 0.1);
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
