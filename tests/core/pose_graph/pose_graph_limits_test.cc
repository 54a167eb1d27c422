// Limits of a graph, tested with two poses whose solution is known by hand:
// which poses are determined, and the final widths of losses.

#include <gtest/gtest.h>

#include <cmath>
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
