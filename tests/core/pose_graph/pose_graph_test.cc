#include "core/pose_graph/pose_graph.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "core/pose_graph/graph_problem.h"
#include "robust/m_estimator.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/graph_world.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The circle as measured by odometry: from pose to pose, with growing drift.
struct Circle {
  explicit Circle(int poses, unsigned seed = 1)
      : world(seed), truth(CircleOfPoses(poses, 3.0)) {
    for (int i = 1; i < poses; ++i) {
      edges.push_back(MeasuredEdge(truth, i - 1, i, 0.002, 0.002, &world));
    }
  }

  PoseGraph Graph(const PoseGraphOptions& options = {},
                  bool is_fixed = true) const {
    PoseGraph graph(options);
    Rigid3d pose = truth[0];
    graph.AddPose(pose, is_fixed);
    for (const RelativePose& edge : edges) {
      pose = pose * edge.cur_from_ref.Inverse();
      graph.AddPose(pose);
      graph.AddEdge(edge);
    }
    return graph;
  }

  RandomWorld world;
  std::vector<Rigid3d> truth;
  std::vector<RelativePose> edges;
};

TEST(PoseGraphTest, ATreeTellsNothingTwice) {
  Circle circle(4);
  EXPECT_EQ(circle.Graph().OvercountingFactor(), 1.0);
  PoseGraph alone;
  alone.AddPose(Rigid3d());
  EXPECT_EQ(alone.OvercountingFactor(), 1.0);
  PoseGraph fixed;
  fixed.AddPose(Rigid3d(), /*is_fixed=*/true);
  EXPECT_EQ(fixed.OvercountingFactor(), 1.0);
  PoseGraph graph = circle.Graph();
  for (int i = 0; i < 3; ++i) graph.AddEdge(circle.edges[0]);
  EXPECT_EQ(graph.OvercountingFactor(), 2.0);
}

// Nor does it leak memory, which a sanitizer shows.
TEST(PoseGraphTest, AGraphWithoutPosesIsSolved) {
  PoseGraph graph;
  const GraphSolution solution = graph.Solve();
  EXPECT_TRUE(solution.ok()) << solution.reason;
  EXPECT_EQ(solution.final_cost, 0.0);
}

TEST(PoseGraphTest, RefusesDirectionsThatAreNone) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const auto reason = [](int a, int b, const CommonDirectionFactor& factor) {
    PoseGraph graph = Circle(4).Graph();
    graph.AddDirection(a, b, factor);
    return graph.Solve().reason;
  };
  EXPECT_EQ(reason(1, 2, {z, z, 0.1}), "");
  EXPECT_EQ(reason(1, 4, {z, z, 0.1}),
            "the direction in pose 1 and pose 4 is not one in two poses of the "
            "graph");
  EXPECT_NE(reason(2, 2, {z, z, 0.1}), "");
  EXPECT_NE(reason(1, 2, {2.0 * z, z, 0.1}), "");
  EXPECT_NE(reason(1, 2, {z, kNan * z, 0.1}), "");
  EXPECT_NE(reason(1, 2, {z, z, 0.0}), "");
}

// Edges between fixed poses tell nothing, and fixed poses need no edge.
TEST(PoseGraphTest, FixedPosesDoNotDiluteTheFactor) {
  Circle circle(4);
  PoseGraph graph;
  for (int i = 0; i < 4; ++i) graph.AddPose(circle.truth[i], i < 3);
  for (const RelativePose& edge : circle.edges) graph.AddEdge(edge);
  for (int i = 0; i < 5; ++i) graph.AddEdge(circle.edges[2]);
  EXPECT_EQ(graph.OvercountingFactor(), 6.0);
  const auto twice = graph.MarginalCovariances({3, 3});
  ASSERT_EQ(twice.size(), 2u);
  EXPECT_EQ(twice[0], twice[1]);
  EXPECT_GT(twice[0](0, 0), 0.0);
  for (const int none : {-1, 4}) {
    ExpectInputError(
        [&] {
          graph.MarginalCovariances({0, none});
        },
        {"there is no pose " + std::to_string(none)});
  }
}

TEST(PoseGraphTest, ExactEdgesBringPosesBack) {
  Circle circle(20);
  PoseGraph graph;
  for (size_t i = 0; i < circle.truth.size(); ++i) {
    graph.AddPose(i == 0 ? circle.truth[0]
                         : circle.truth[i] * circle.world.Motion(0.5, 0.5),
                  i == 0);
  }
  for (int i = 0; i < 20; ++i) {
    RelativePose edge =
        MeasuredEdge(circle.truth, i, (i + 1) % 20, 0.01, 0.01, &circle.world);
    edge.cur_from_ref = circle.truth[edge.cur].Inverse() * circle.truth[i];
    graph.AddEdge(edge);
  }
  const GraphSolution solution = graph.Solve();
  ASSERT_TRUE(solution.ok()) << solution.reason;
  EXPECT_GT(solution.initial_cost, 1.0);
  EXPECT_LT(solution.final_cost, 1e-12);
  for (int i = 0; i < 20; ++i) {
    const MotionError error = ErrorOf(graph.pose(i), circle.truth[i]);
    EXPECT_LT(error.angle + error.translation, 1e-7) << i;
  }
}

TEST(PoseGraphTest, ALoopTakesDriftBack) {
  Circle circle(100);
  PoseGraph graph = circle.Graph();
  const double drift = RmsDistance(graph, circle.truth);
  graph.AddEdge(MeasuredEdge(circle.truth, 0, 99, 0.002, 0.002, &circle.world));
  ASSERT_TRUE(graph.Solve().ok());
  EXPECT_LT(RmsDistance(graph, circle.truth), 0.6 * drift);
}

// 30 of 43 loops are right. Losses are narrowed step by step, since right loops
// are many sigmas off, too, before the graph is solved.
TEST(PoseGraphTest, PlantedFalseLoopsDoNoHarm) {
  const auto loss = ParseLoss("tukey").Make(6);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Circle circle(100, seed);
    PoseGraphOptions options;
    options.graduated = true;
    PoseGraph right = circle.Graph(options);
    PoseGraph both = circle.Graph(options);
    for (int loop = 0; loop < 30; ++loop) {
      const int ref = 3 * loop;
      const int cur = (ref + 30 + 7 * (loop % 5)) % 100;
      const RelativePose edge =
          MeasuredEdge(circle.truth, ref, cur, 0.002, 0.002, &circle.world);
      right.AddEdge(edge, loss.get());
      both.AddEdge(edge, loss.get());
    }
    for (int loop = 0; loop < 13; ++loop) {
      RelativePose edge =
          MeasuredEdge(circle.truth, 7 * loop, (7 * loop + 45) % 100, 0.002,
                       0.002, &circle.world);
      edge.cur_from_ref = circle.world.Motion(1.0, 1.0);
      both.AddEdge(edge, loss.get());
    }
    ASSERT_TRUE(right.Solve().ok());
    ASSERT_TRUE(both.Solve().ok());
    EXPECT_LT(RmsDistance(both, circle.truth),
              1.05 * RmsDistance(right, circle.truth) + 1e-4)
        << "seed " << seed;
  }
}

// Even if the loss is on all edges, so that those of the odometry give way to
// wrong loops while losses are wide. What is better at the final widths is
// kept.
TEST(PoseGraphTest, GraduationDoesNoHarm) {
  const auto loss = ParseLoss("cauchy").Make(6);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Circle circle(100, seed);
    std::vector<RelativePose> edges = circle.edges;
    for (int loop = 0; loop < 60; ++loop) {
      const int ref = (17 * loop) % 100;
      edges.push_back(MeasuredEdge(circle.truth, ref,
                                   (ref + 20 + 7 * (loop % 9)) % 100, 0.002,
                                   0.002, &circle.world));
      if (loop % 10 < 3) {
        edges.back().cur_from_ref = circle.world.Motion(1.0, 1.0);
      }
    }
    for (const bool graduated : {false, true}) {
      PoseGraphOptions options;
      options.graduated = graduated;
      const PoseGraph start = circle.Graph();
      PoseGraph graph(options);
      for (int i = 0; i < 100; ++i) graph.AddPose(start.pose(i), i == 0);
      for (const auto& edge : edges) graph.AddEdge(edge, loss.get());
      const GraphSolution solution = graph.Solve();
      ASSERT_TRUE(solution.ok()) << solution.reason;
      EXPECT_LT(RmsDistance(graph, circle.truth), 0.05)
          << "seed " << seed << (graduated ? ", graduated" : "");
    }
  }
}

RelativePose AnyEdge(int ref, int cur) {
  RelativePose edge;
  edge.ref = ref;
  edge.cur = cur;
  edge.covariance.setIdentity();
  return edge;
}

// An edge from pose 0 to pose 2 that is changed.
auto EdgeWith(void (*spoil)(RelativePose* edge)) {
  return [spoil](PoseGraph* graph) {
    RelativePose edge = AnyEdge(0, 2);
    spoil(&edge);
    graph->AddEdge(edge);
  };
}

auto PoseWith(void (*spoil)(Rigid3d* pose)) {
  return [spoil](PoseGraph* graph) {
    Rigid3d pose;
    spoil(&pose);
    graph->AddPose(pose);
  };
}

TEST(PoseGraphTest, ABadGraphIsAStatusAndMovesNothing) {
  const std::string kEdge = "the edge from pose 0 to pose 2 has a ";
  const struct {
    std::function<void(PoseGraph*)> spoil;
    GraphStatus status;
    std::string reason;
  } kCases[] = {
      {[](PoseGraph* g) { *g = Circle(5).Graph({}, /*is_fixed=*/false); },
       GraphStatus::kNotAnchored, "pose 0 is not connected to any fixed pose"},
      {[](PoseGraph* g) { g->AddPose(Rigid3d()); }, GraphStatus::kNotAnchored,
       "pose 5 is not connected to any fixed pose"},
      {PoseWith([](Rigid3d* pose) { pose->translation.x() = kNan; }),
       GraphStatus::kBadInput, "pose 5 is not finite"},
      {PoseWith([](Rigid3d* pose) { pose->rotation.coeffs().setZero(); }),
       GraphStatus::kBadInput,
       "pose 5 has a quaternion of length 0 instead of 1"},
      {EdgeWith([](RelativePose* edge) {
         edge->cur_from_ref.rotation.coeffs() *= 3.0;
       }),
       GraphStatus::kBadInput,
       kEdge + "motion that has a quaternion of length 3 instead of 1"},
      {EdgeWith([](RelativePose* edge) {
         edge->cur_from_ref.translation.x() = kNan;
       }),
       GraphStatus::kBadInput, kEdge + "motion that is not finite"},
      {EdgeWith([](RelativePose* edge) { edge->covariance.setZero(); }),
       GraphStatus::kBadInput,
       kEdge + "covariance that is not positive definite"},
      {EdgeWith([](RelativePose* edge) { edge->covariance(3, 3) = -1.0; }),
       GraphStatus::kBadInput,
       kEdge + "covariance that is not positive definite"},
      {EdgeWith([](RelativePose* edge) { edge->covariance(0, 5) = 0.5; }),
       GraphStatus::kBadInput, kEdge + "covariance that is not symmetric"},
      {[](PoseGraph* g) { g->AddEdge(AnyEdge(0, 7)); }, GraphStatus::kBadInput,
       "the edge from pose 0 to pose 7 does not connect two poses of the "
       "graph"}};
  for (const auto& bad : kCases) {
    PoseGraph graph = Circle(5).Graph();
    // A loop that would move the last pose.
    graph.AddEdge(AnyEdge(0, 4));
    const Rigid3d before = graph.pose(4);
    bad.spoil(&graph);
    const GraphSolution solution = graph.Solve();
    EXPECT_EQ(solution.status, bad.status) << bad.reason;
    EXPECT_EQ(solution.reason, bad.reason);
    EXPECT_EQ(graph.pose(4).translation, before.translation);
  }
}

}  // namespace
}  // namespace rgbd_pose
