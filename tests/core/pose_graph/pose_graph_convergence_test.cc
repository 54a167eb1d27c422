// A solve that says ok has arrived, from wherever it began.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/pose_graph/pose_graph.h"
#include "tests/support/graph_world.h"

namespace rgbd_pose {
namespace {

constexpr int kPosesPerLap = 50;

// The poses along laps round a circle; each third is measured from the lap
// before as well. They start at the truth or where odometry puts them: metres
// away.
PoseGraph Laps(int laps, double sigma, bool start_at_truth,
               const PoseGraphOptions& options) {
  RandomWorld world(4);
  std::vector<Rigid3d> truth;
  for (int lap = 0; lap < laps; ++lap) {
    for (Rigid3d pose : CircleOfPoses(kPosesPerLap, 3.0)) {
      pose.translation.y() += 0.1 * lap;
      truth.push_back(pose);
    }
  }
  PoseGraph graph(options);
  Rigid3d pose = truth[0];
  graph.AddPose(pose, /*is_fixed=*/true);
  for (int i = 1; i < static_cast<int>(truth.size()); ++i) {
    const RelativePose edge =
        MeasuredEdge(truth, i - 1, i, sigma, sigma, &world);
    pose = pose * edge.cur_from_ref.Inverse();
    graph.AddPose(start_at_truth ? truth[i] : pose);
    graph.AddEdge(edge);
    if (i < kPosesPerLap || i % 3 != 0) continue;
    graph.AddEdge(
        MeasuredEdge(truth, i - kPosesPerLap, i, sigma, sigma, &world));
  }
  return graph;
}

double LargestStep(const PoseGraph& a, const PoseGraph& b) {
  double largest = 0.0;
  for (int i = 0; i < a.num_poses(); ++i) {
    const Rigid3d step = a.pose(i) * b.pose(i).Inverse();
    largest = std::max({largest, step.Angle(),
                        (a.pose(i).translation - b.pose(i).translation)
                            .lpNorm<Eigen::Infinity>()});
  }
  return largest;
}

TEST(PoseGraphConvergenceTest, TheResultDoesNotDependOnTheStart) {
  PoseGraphOptions options;
  options.max_standard_deviation = 10.0;
  for (const int laps : {4, 40}) {
    for (const double sigma : {0.01, 0.03}) {
      PoseGraph near = Laps(laps, sigma, true, options);
      PoseGraph far = Laps(laps, sigma, false, options);
      ASSERT_TRUE(near.Solve().ok());
      const GraphSolution solution = far.Solve();
      ASSERT_TRUE(solution.ok()) << solution.reason;
      EXPECT_LE(solution.iterations, 30) << laps << " laps, " << sigma;
      EXPECT_LT(LargestStep(near, far), 2.0 * options.step_tolerance)
          << laps << " laps, " << sigma;
      const PoseGraph before = far;
      ASSERT_TRUE(far.Solve().ok());
      EXPECT_LT(LargestStep(before, far), 2.0 * options.step_tolerance);
    }
  }
}

// One round cannot tell whether it arrived.
TEST(PoseGraphConvergenceTest, WhatStillMovesIsNotOk) {
  PoseGraphOptions options;
  options.max_rounds = 1;
  PoseGraph graph = Laps(4, 0.03, false, options);
  const PoseGraph before = graph;
  const GraphSolution solution = graph.Solve();
  EXPECT_EQ(solution.status, GraphStatus::kNotConverged);
  EXPECT_NE(solution.reason.find("still moved by"), std::string::npos)
      << solution.reason;
  EXPECT_EQ(solution.final_cost, solution.initial_cost);
  EXPECT_TRUE(graph.pose(199) == before.pose(199));
}

}  // namespace
}  // namespace rgbd_pose
