#include "core/estimation/motion_graph.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/estimation/graph_blocks.h"
#include "costs/cost_factory.h"
#include "robust/m_estimator.h"
#include "tests/support/graph_world.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The circle as odometry tells it: from pose to pose, so that errors add up.
struct Circle {
  explicit Circle(int poses, unsigned seed = 1)
      : world(seed), truth(CircleOfPoses(poses, 3.0)) {
    for (int i = 1; i < poses; ++i) {
      edges.push_back(MeasuredEdge(truth, i - 1, i, 0.002, 0.002, &world));
    }
  }

  MotionGraph Graph(const MotionGraphOptions& options = {}) const {
    MotionGraph graph(options);
    Rigid3d pose = truth[0];
    graph.AddPose(pose, /*is_fixed=*/true);
    for (const Edge& edge : edges) {
      pose = pose * edge.cur_from_ref.Inverse();
      graph.AddPose(pose);
      graph.AddEdge(edge);
    }
    return graph;
  }

  RandomWorld world;
  std::vector<Rigid3d> truth;
  std::vector<Edge> edges;
};

TEST(MotionGraphTest, ATreeTellsNothingTwice) {
  Circle circle(4);
  EXPECT_EQ(circle.Graph().Redundancy(), 1.0);
  MotionGraph alone;
  alone.AddPose(Rigid3d());
  EXPECT_EQ(alone.Redundancy(), 1.0);
  // A live pair counts as an edge.
  const Correspondences matches = circle.world.Matches(9, 0.0, Rigid3d());
  PairData pair;
  pair.matches = &matches;
  MotionGraph graph = circle.Graph();
  for (int i = 0; i < 3; ++i) {
    graph.AddPair(0, 1, pair, MakeRobustCosts("point_to_point", "none"));
  }
  EXPECT_EQ(graph.Redundancy(), 2.0);
}

TEST(EdgeBlockTest, JacobianIsThatOfTheOracle) {
  RandomWorld world(3);
  for (int trial = 0; trial < 50; ++trial) {
    const MotionOrigin ref(world.Motion(2.0, 2.0)), cur(world.Motion(2.0, 2.0));
    MotionVector x[2];
    for (MotionVector& pose : x) {
      pose << world.Vector(0.3), world.Vector(0.3);
    }
    MotionMatrix root;
    for (double& value : root.reshaped()) value = world.Uniform(-1.0, 1.0);
    const Rigid3d measured = ref.CurFromPrev(x[0].data()).Inverse();
    const EdgeTerm term = EdgeTerm::Of(
        cur.CurFromPrev(x[1].data()) * measured * world.Motion(2.0, 1.0), root);
    const std::unique_ptr<ceres::CostFunction> oracle(
        MakeEdgeOracle(term, &ref, &cur));
    const double* at[] = {x[0].data(), x[1].data()};
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> hand[2], jet[2];
    double* by_hand[] = {hand[0].data(), hand[1].data()};
    double* by_jet[] = {jet[0].data(), jet[1].data()};
    MotionVector r, r_jet;
    ASSERT_TRUE(EdgeBlock(term, &ref, &cur).Evaluate(at, r.data(), by_hand));
    ASSERT_TRUE(oracle->Evaluate(at, r_jet.data(), by_jet));
    EXPECT_LT((r - r_jet).norm(), 1e-12);
    EXPECT_LT((hand[0] - jet[0]).norm(), 1e-11);
    EXPECT_LT((hand[1] - jet[1]).norm(), 1e-11);
  }
}

TEST(MotionGraphTest, ExactEdgesBringPosesBack) {
  Circle circle(20);
  MotionGraph graph;
  for (size_t i = 0; i < circle.truth.size(); ++i) {
    graph.AddPose(i == 0 ? circle.truth[0]
                         : circle.truth[i] * circle.world.Motion(0.5, 0.5),
                  i == 0);
  }
  for (int i = 0; i < 20; ++i) {
    Edge edge =
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

TEST(MotionGraphTest, ALoopTakesDriftBack) {
  Circle circle(100);
  MotionGraph graph = circle.Graph();
  const double drift = RmsDistance(graph, circle.truth);
  graph.AddEdge(MeasuredEdge(circle.truth, 0, 99, 0.002, 0.002, &circle.world));
  ASSERT_TRUE(graph.Solve().ok());
  EXPECT_LT(RmsDistance(graph, circle.truth), 0.6 * drift);
}

// 30 of 43 loops are right. Losses narrow step by step, since right ones are
// many sigmas off as well before the graph is solved.
TEST(MotionGraphTest, PlantedFalseLoopsDoNoHarm) {
  const auto loss = FindMEstimator("tukey")->MakeLoss(6);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Circle circle(100, seed);
    MotionGraphOptions options;
    options.graduated = true;
    MotionGraph right = circle.Graph(options);
    MotionGraph both = circle.Graph(options);
    for (int loop = 0; loop < 30; ++loop) {
      const int ref = 3 * loop;
      const int cur = (ref + 30 + 7 * (loop % 5)) % 100;
      const Edge edge =
          MeasuredEdge(circle.truth, ref, cur, 0.002, 0.002, &circle.world);
      right.AddEdge(edge, loss.get());
      both.AddEdge(edge, loss.get());
    }
    for (int loop = 0; loop < 13; ++loop) {
      Edge edge = MeasuredEdge(circle.truth, 7 * loop, (7 * loop + 45) % 100,
                               0.002, 0.002, &circle.world);
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

// Three frames that see each other, with wrong matches among them.
MotionGraph LiveGraph(Assembly assembly) {
  RandomWorld world(5);
  MotionGraphOptions options;
  options.assembly = assembly;
  options.settled_within = 1e-9;
  options.max_rounds = 30;
  MotionGraph graph(options);
  std::vector<Rigid3d> truth;
  for (int i = 0; i < 3; ++i) {
    truth.push_back(world.Motion(0.1, 0.1));
    graph.AddPose(i == 0 ? truth[0] : truth[i] * world.Motion(0.01, 0.01),
                  i == 0);
  }
  for (int ref = 0; ref < 3; ++ref) {
    const int cur = (ref + 1) % 3;
    const Correspondences matches =
        world.Matches(100, 0.2, truth[cur].Inverse() * truth[ref]);
    PairData pair;
    pair.matches = &matches;
    graph.AddPair(ref, cur, pair,
                  MakeRobustCosts("mahalanobis_point", "huber"));
  }
  graph.AddEdge(MeasuredEdge(truth, 0, 2, 0.01, 0.01, &world));
  return graph;
}

// Their weights are chosen by the motion between the poses, wherever these are.
TEST(MotionGraphTest, LivePairsDoNotDependOnTheWorld) {
  RandomWorld world(9);
  const Rigid3d truth = world.Motion(0.2, 0.3);
  const Correspondences matches = world.Matches(60, 0.1, truth);
  PairData pair;
  pair.matches = &matches;
  const auto cur_from_ref = [&](const Rigid3d& ref) {
    MotionGraphOptions options;
    options.max_rounds = 1;
    MotionGraph graph(options);
    graph.AddPose(ref, /*is_fixed=*/true);
    graph.AddPose(ref * truth.Inverse());
    graph.AddPair(0, 1, pair, MakeRobustCosts("mahalanobis_point", "huber"));
    EXPECT_TRUE(graph.Solve().ok());
    return graph.pose(1).Inverse() * ref;
  };
  const MotionError error =
      ErrorOf(cur_from_ref(world.Motion(1.5, 2.0)), cur_from_ref(Rigid3d()));
  EXPECT_LT(error.angle + error.translation, 1e-6);
}

TEST(MotionGraphTest, AllAssembliesOfLivePairsAgree) {
  MotionGraph compressed = LiveGraph(Assembly::kCompressed);
  const GraphSolution expected = compressed.Solve();
  ASSERT_TRUE(expected.ok()) << expected.reason;
  EXPECT_LT(expected.final_cost, expected.initial_cost);
  for (const Assembly assembly : {Assembly::kPerMatch, Assembly::kAutodiff}) {
    MotionGraph graph = LiveGraph(assembly);
    const GraphSolution solution = graph.Solve();
    ASSERT_TRUE(solution.ok()) << solution.reason;
    EXPECT_NEAR(solution.initial_cost, expected.initial_cost,
                1e-9 * expected.initial_cost);
    EXPECT_NEAR(solution.final_cost, expected.final_cost,
                1e-9 * expected.final_cost);
    for (int i = 0; i < 3; ++i) {
      const MotionError error = ErrorOf(graph.pose(i), compressed.pose(i));
      EXPECT_LT(error.angle + error.translation, 1e-7);
    }
  }
}

TEST(MotionGraphTest, LivePairsFindWhatTheEstimatorFinds) {
  RandomWorld world(9);
  const Rigid3d truth = world.Motion(0.05, 0.05);
  const Correspondences matches = world.Matches(200, 0.0, truth);
  EstimatorOptions estimator;
  estimator.schedule = RobustSchedule::kDirect;
  const MotionEstimate estimate =
      Estimator(estimator, MakeRobustCosts("mahalanobis_point", "tukey"))
          .Estimate(matches, truth);
  MotionGraph graph;
  graph.AddPose(Rigid3d(), true);
  graph.AddPose(truth.Inverse());
  PairData pair;
  pair.matches = &matches;
  graph.AddPair(0, 1, pair, MakeRobustCosts("mahalanobis_point", "tukey"));
  ASSERT_TRUE(graph.Solve().ok());
  const MotionError error =
      ErrorOf(graph.pose(1).Inverse(), estimate.cur_from_prev);
  EXPECT_LT(error.angle + error.translation, 1e-5);
  // One pair, one pose: its covariance is the estimate's, with the centre in
  // the axes of a camera that is the world.
  const std::vector<MotionMatrix> covariances = graph.Covariances({0, 1});
  ASSERT_EQ(covariances.size(), 2U);
  EXPECT_TRUE(covariances[0].isZero());
  EXPECT_GT(covariances[1].trace(), 0.3 * estimate.covariance.trace());
  EXPECT_LT(covariances[1].trace(), 3.0 * estimate.covariance.trace());
}

TEST(MotionGraphTest, PriorsAnchorAndPull) {
  MotionGraph graph;
  graph.AddPose(Rigid3d());
  RandomWorld world(2);
  MotionPrior prior;
  prior.mean = world.Motion(1.0, 1.0);
  prior.information.setIdentity();
  prior.information *= 1e4;
  graph.AddPrior(0, prior);
  ASSERT_TRUE(graph.Solve().ok());
  EXPECT_LT(ErrorOf(graph.pose(0), prior.mean.Inverse()).translation, 1e-6);
}

struct BadCase {
  const char* name;
  void (*spoil)(MotionGraph* graph);
  GraphStatus status;
  const char* reason;
};

Edge AnyEdge(int ref, int cur) {
  Edge edge;
  edge.ref = ref;
  edge.cur = cur;
  edge.covariance.setIdentity();
  return edge;
}

class BadGraphTest : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadGraphTest, IsAStatusAndMovesNothing) {
  MotionGraph graph = Circle(5).Graph();
  graph.SetPose(4, graph.pose(4) * Rigid3d(Eigen::Quaterniond::Identity(),
                                           {0.1, 0.0, 0.0}));
  const Rigid3d before = graph.pose(4);
  GetParam().spoil(&graph);
  const GraphSolution solution = graph.Solve();
  EXPECT_EQ(solution.status, GetParam().status) << solution.reason;
  EXPECT_EQ(solution.reason, GetParam().reason);
  EXPECT_EQ(graph.pose(4).translation, before.translation);
}

INSTANTIATE_TEST_SUITE_P(
    , BadGraphTest,
    ::testing::Values(
        BadCase{"no_gauge", [](MotionGraph* g) { g->SetFixed(0, false); },
                GraphStatus::kNotAnchored,
                "pose 0 and those joined to it hang on nothing that is fixed"},
        BadCase{"disconnected", [](MotionGraph* g) { g->AddPose(Rigid3d()); },
                GraphStatus::kNotAnchored,
                "pose 5 and those joined to it hang on nothing that is fixed"},
        BadCase{"nan_pose",
                [](MotionGraph* g) {
                  Rigid3d pose;
                  pose.translation.x() = kNan;
                  g->SetPose(2, pose);
                },
                GraphStatus::kBadInput, "pose 2 is not finite"},
        BadCase{"nan_edge",
                [](MotionGraph* g) {
                  Edge edge = AnyEdge(0, 2);
                  edge.cur_from_ref.translation.x() = kNan;
                  g->AddEdge(edge);
                },
                GraphStatus::kBadInput,
                "the edge from pose 0 to pose 2 has a motion that is not "
                "finite"},
        BadCase{"no_covariance",
                [](MotionGraph* g) {
                  Edge edge = AnyEdge(0, 2);
                  edge.covariance.setZero();
                  g->AddEdge(edge);
                },
                GraphStatus::kBadInput,
                "the edge from pose 0 to pose 2 has a covariance that is none"},
        BadCase{"negative_covariance",
                [](MotionGraph* g) {
                  Edge edge = AnyEdge(0, 2);
                  edge.covariance(3, 3) = -1.0;
                  g->AddEdge(edge);
                },
                GraphStatus::kBadInput,
                "the edge from pose 0 to pose 2 has a covariance that is none"},
        BadCase{"unknown_pose",
                [](MotionGraph* g) { g->AddEdge(AnyEdge(0, 7)); },
                GraphStatus::kBadInput,
                "the edge from pose 0 to pose 7 is not between two poses of "
                "the graph"},
        BadCase{"singular_pair",
                [](MotionGraph* g) {
                  RandomWorld world(1);
                  const Correspondences one = world.Matches(1, 0.0, Rigid3d());
                  PairData pair;
                  pair.matches = &one;
                  g->AddPose(Rigid3d());
                  g->AddPair(4, 5, pair,
                             MakeRobustCosts("point_to_point", "none"));
                },
                GraphStatus::kSingular, "pose 5 is not determined"}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace rgbd_pose
