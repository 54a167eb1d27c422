// Limits of a graph, tested with two poses whose solution is known by hand:
// which poses are determined, and the final widths of losses.

#include <ceres/loss_function.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/pose_graph/pose_graph.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

// Adds a fixed and a free pose; returns an edge between them, to be completed.
RelativePose AddTwoPoses(PoseGraph* graph) {
  RelativePose edge;
  edge.ref = graph->AddPose(Rigid3d(), /*is_fixed=*/true);
  edge.cur = graph->AddPose(Rigid3d());
  return edge;
}

// A pose is determined if the standard deviation of its weakest direction is
// below the limit, here just below or just above.
TEST(PoseGraphTest, TheLimitIsAStandardDeviation) {
  for (const double ratio : {0.9, 1.1}) {
    PoseGraphOptions options;
    options.max_standard_deviation = 0.3;
    PoseGraph graph(options);
    RelativePose edge = AddTwoPoses(&graph);
    edge.covariance = 1e-4 * MotionMatrix::Identity();
    edge.covariance(4, 4) = std::pow(ratio * options.max_standard_deviation, 2);
    edge.cur_from_ref.translation.x() = 0.1;
    graph.AddEdge(edge);
    const GraphSolution solution = graph.Solve();
    EXPECT_EQ(solution.status,
              ratio < 1.0 ? GraphStatus::kOk : GraphStatus::kSingular);
    // Without a solution the poses stay, and their cost.
    EXPECT_GT(solution.initial_cost, 0.1);
    EXPECT_NEAR(solution.final_cost,
                solution.ok() ? 0.0 : solution.initial_cost, 1e-9);
    EXPECT_EQ(graph.pose(1).translation.isZero(), !solution.ok());
    EXPECT_GT(solution.iterations, 0);
  }
}

// A straight path of poses, as known from edges between neighbours alone; one
// of the poses is fixed, and they are numbered from one end or from the other.
PoseGraph StraightPath(int poses, int fixed, bool is_backwards) {
  PoseGraph graph;
  const auto number = [&](int i) { return is_backwards ? poses - 1 - i : i; };
  for (int i = 0; i < poses; ++i) {
    const Eigen::Vector3d position(0.1 * number(i), 0.0, 0.0);
    graph.AddPose({Eigen::Quaterniond::Identity(), position},
                  number(i) == fixed);
  }
  for (int i = 1; i < poses; ++i) {
    RelativePose edge;
    edge.ref = number(i - 1);
    edge.cur = number(i);
    edge.cur_from_ref.translation.x() = -0.1;
    edge.covariance = 1e-6 * MotionMatrix::Identity();
    graph.AddEdge(edge);
  }
  return graph;
}

// A long path is determined, though its far end is known to metres only; where
// it is fixed and how its poses are numbered does not matter.
TEST(PoseGraphTest, ALongPathIsDeterminedWhereverItIsFixed) {
  constexpr int kPoses = 1000;
  for (const int fixed : {0, 250, 500, kPoses - 1}) {
    for (const bool is_backwards : {false, true}) {
      PoseGraph graph = StraightPath(kPoses, fixed, is_backwards);
      const GraphSolution solution = graph.Solve();
      EXPECT_TRUE(solution.ok()) << solution.reason;
      const int far = fixed < kPoses / 2 ? kPoses - 1 : 0;
      const double n = std::abs(far - fixed);
      const auto covariances =
          graph.MarginalCovariances({is_backwards ? kPoses - 1 - far : far});
      ASSERT_EQ(covariances.size(), 1U);
      EXPECT_NEAR(covariances[0](0, 0), 1e-6 * n, 1e-11 * n);
      EXPECT_NEAR(covariances[0](3, 3), 1e-6 * n, 1e-11 * n);
      // Each pose on the way turns by 1 mrad, which moves the end sideways: by
      // 1 mrad times 0.1 m, 0.2 m, ...; the last turn is that of the end
      // itself.
      const double m = far > fixed ? n - 1 : n;
      EXPECT_NEAR(covariances[0](4, 4),
                  1e-6 * n + 1e-8 * m * (m + 1) * (2 * m + 1) / 6, 1e-6);
    }
  }
}

// Each of two edges leaves another direction of pose 1 open, to 3 m; together
// they determine it. Without the second one it is not determined, nor what is
// linked to it, wherever the path is fixed.
TEST(PoseGraphTest, EdgesDetermineAPoseTogether) {
  for (const bool both : {true, false}) {
    for (const int fixed : {0, 1, 2}) {
      PoseGraph graph;
      for (int i = 0; i < 3; ++i) graph.AddPose(Rigid3d(), i == fixed);
      const auto add = [&](int ref, int cur, int weak) {
        RelativePose edge;
        edge.ref = ref;
        edge.cur = cur;
        edge.covariance = 1e-4 * MotionMatrix::Identity();
        if (weak >= 0) edge.covariance(weak, weak) = 9.0;
        graph.AddEdge(edge);
      };
      add(0, 1, 3);
      if (both) add(0, 1, 4);
      add(1, 2, -1);
      const GraphSolution solution = graph.Solve();
      EXPECT_EQ(solution.ok(), both) << solution.reason;
      if (both) continue;
      EXPECT_EQ(solution.reason,
                std::string(fixed == 0 ? "pose 1" : "pose 0") +
                    " is not determined: no path of motions with standard "
                    "deviations of at most 0.5 (rad, m) leads to a fixed pose");
    }
  }
}

// Neither of two edges alone determines a pose; both together just do, or just
// do not, in the direction `weak`. They measure `apart` to either side of where
// the pose is, under a loss of whose slope there `share` is left.
void ExpectTheLimitOfTwoEdges(int weak, double apart, double share,
                              const ceres::LossFunction* loss) {
  for (const double ratio : {0.97, 1.03}) {
    PoseGraphOptions options;
    options.max_standard_deviation = 0.3;
    PoseGraph graph(options);
    // Far from the axes of the world.
    const Rigid3d turned =
        Rigid3d::FromRotationVector({0.0, 0.0, 2.8}, {1.0, 2.0, 3.0});
    RelativePose edge;
    edge.ref = graph.AddPose(turned, /*is_fixed=*/true);
    edge.cur = graph.AddPose(turned);
    const double sigma =
        ratio * options.max_standard_deviation * std::sqrt(2.0 * share);
    edge.covariance = 1e-4 * MotionMatrix::Identity();
    edge.covariance(weak, weak) = sigma * sigma;
    for (const double side : {-apart, apart}) {
      edge.cur_from_ref.translation.y() = side * sigma;
      graph.AddEdge(edge, loss);
    }
    const GraphSolution solution = graph.Solve();
    EXPECT_EQ(solution.ok(), ratio < 1.0) << solution.reason;
  }
}

TEST(PoseGraphTest, TheLimitOfTwoEdgesIsThatOfOne) {
  ExpectTheLimitOfTwoEdges(/*weak=*/2, /*apart=*/0.0, 1.0, nullptr);
}

TEST(PoseGraphTest, TheLimitIsThatUnderTheLossAsItIs) {
  const ceres::SoftLOneLoss loss(1.0);
  double rho[3];
  loss.Evaluate(16.0, rho);
  ExpectTheLimitOfTwoEdges(/*weak=*/4, /*apart=*/4.0, rho[1], &loss);
}

// Two edges put a pose at 0 m and one at 10 m, each +- 1 m, under Huber's loss.
// All of them pull; the far one with the loss's maximum force. Hence the pose
// is at half the width of the loss.
TEST(PoseGraphTest, LossesHaveTheirOwnWidthsInTheEnd) {
  const auto huber = ParseLoss("huber").Make(6);
  double rho[3];
  huber->Evaluate(100.0, rho);
  const double width = rho[1] * 10.0;
  for (const bool graduated : {false, true}) {
    PoseGraphOptions options;
    options.graduated = graduated;
    options.max_standard_deviation = 2.0;
    PoseGraph graph(options);
    RelativePose edge = AddTwoPoses(&graph);
    edge.covariance.setIdentity();
    graph.AddEdge(edge, huber.get());
    graph.AddEdge(edge, huber.get());
    edge.cur_from_ref.translation.x() = -10.0;
    graph.AddEdge(edge, huber.get());
    const GraphSolution solution = graph.Solve();
    ASSERT_TRUE(solution.ok()) << solution.reason;
    EXPECT_NEAR(solution.initial_cost, 0.5 * rho[0], 1e-9);
    const double x = width / 2.0, far = 10.0 - x;
    EXPECT_NEAR(graph.pose(1).translation.x(), x, 1e-4);
    EXPECT_NEAR(solution.final_cost, x * x + width * far - width * width / 2.0,
                1e-3);
    EXPECT_GT(solution.iterations, 0);
    EXPECT_EQ(graph.OvercountingFactor(), 3.0);
    // Across the line, a far edge counts with its weight.
    const std::vector<MotionMatrix> covariances =
        graph.MarginalCovariances({1});
    ASSERT_EQ(covariances.size(), 1U);
    EXPECT_NEAR(covariances[0](4, 4), 1.0 / (2.0 + width / far), 1e-5);
  }
}

}  // namespace
}  // namespace rgbd_pose
