// Monte Carlo test: do the covariances of a graph's poses match their errors?

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/pose_graph/pose_graph.h"
#include "costs/cost_factory.h"
#include "tests/support/graph_world.h"

namespace rgbd_pose {
namespace {

// The errors of poses are those of the motions from the world to the cameras.
double Nees(const PoseGraph& graph, const std::vector<Rigid3d>& truth, int pose,
            double factor) {
  const MotionMatrix covariance =
      factor * graph.MarginalCovariances({pose}).at(0);
  return SquaredMahalanobisDistance(graph.pose(pose).Inverse(),
                                    truth[pose].Inverse(), covariance);
}

// A loop of independent edges.
TEST(PoseGraphCovarianceTest, IndependentEdgesAreHonest) {
  constexpr int kTrials = 300;
  const std::vector<Rigid3d> truth = CircleOfPoses(12, 2.0);
  double nees = 0.0;
  for (int seed = 0; seed < kTrials; ++seed) {
    RandomWorld world(100 + seed);
    PoseGraph graph;
    for (int i = 0; i < 12; ++i) graph.AddPose(truth[i], i == 0);
    for (int i = 0; i < 12; ++i) {
      graph.AddEdge(MeasuredEdge(truth, i, (i + 1) % 12, 0.003, 0.005, &world));
      graph.AddEdge(MeasuredEdge(truth, i, (i + 5) % 12, 0.005, 0.003, &world));
    }
    ASSERT_TRUE(graph.Solve().ok());
    nees += Nees(graph, truth, 6, 1.0);
  }
  RecordProperty("nees", std::to_string(nees / kTrials));
  EXPECT_NEAR(nees / kTrials, 6.0, 0.6);  // its sigma is 0.2
}

// Five frames that see the same 60 points, each matched with all others: the
// noise of each frame enters four edges.
TEST(PoseGraphCovarianceTest, EdgesThatShareFeaturesAreHonestByRedundancy) {
  constexpr int kTrials = 200, kFrames = 5, kPoints = 60;
  Estimator estimator({}, MakeRobustCosts("mahalanobis_point", "none"));
  double nees = 0.0, naive = 0.0;
  for (int seed = 0; seed < kTrials; ++seed) {
    RandomWorld world(500 + seed);
    std::vector<Rigid3d> truth;
    for (int i = 0; i < kFrames; ++i) truth.push_back(world.Motion(0.1, 0.1));
    std::vector<std::vector<Observation>> seen(kFrames);
    while (seen[0].size() < kPoints) {
      Observation first, other;
      world.Match(Camera(), Rigid3d(), &first, &other);
      const Eigen::Vector3d point =
          truth[0] * Correspondences(Camera()).Point(first);
      for (int i = 0; i < kFrames; ++i) {
        const Eigen::Vector3d p = truth[i].Inverse() * point;
        const Eigen::Vector2d pixel = Camera().Project(p);
        Observation o = first;
        o.u = pixel.x();
        o.v = pixel.y();
        o.depth = p.z();
        o.sigma_depth =
            FindNamed(DepthNoiseModels(), "khoshelham")->sigma(p.z());
        world.AddNoise(&o);
        seen[i].push_back(o);
      }
    }
    PoseGraph graph;
    for (int i = 0; i < kFrames; ++i) graph.AddPose(truth[i], i == 0);
    for (int cur = 1; cur < kFrames; ++cur) {
      for (int ref = 0; ref < cur; ++ref) {
        Correspondences matches{Camera()};
        for (int k = 0; k < kPoints; ++k)
          matches.Add(seen[ref][k], seen[cur][k]);
        const MotionEstimate estimate =
            estimator.Estimate(matches, truth[cur].Inverse() * truth[ref]);
        ASSERT_TRUE(estimate.ok());
        graph.AddEdge({ref, cur, estimate.cur_from_prev, estimate.covariance});
      }
    }
    ASSERT_TRUE(graph.Solve().ok());
    EXPECT_DOUBLE_EQ(graph.OvercountingFactor(), 2.5);  // 10 edges, 4 motions
    nees += Nees(graph, truth, 4, graph.OvercountingFactor());
    naive += Nees(graph, truth, 4, 1.0);
  }
  RecordProperty("nees", std::to_string(nees / kTrials));
  EXPECT_NEAR(nees / kTrials, 6.0, 1.2);
  EXPECT_GT(naive / kTrials, 12.0);
}

}  // namespace
}  // namespace rgbd_pose
