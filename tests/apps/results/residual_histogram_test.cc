#include "apps/results/residual_histogram.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace rgbd_pose {
namespace {

TEST(ResidualHistogram, CountsMatchesThatSomeCostCouldUse) {
  MotionEstimate estimate;
  estimate.residual_norms = {0.0, 0.05, 7.95, 8.05, 1e300, 0.0};
  estimate.residual_degrees = {3, 3, 2, 3, 3, 0};
  estimate.weights = {1.0, 0.97, 0.5, 0.0, 0.0, 0.0};
  ResidualHistogram histogram;
  histogram.Add(estimate);
  histogram.Add(estimate);
  const nlohmann::json json = histogram.ToJson();
  EXPECT_EQ(json.at("matches"), 10);
  const std::vector<int> norms = json.at("norm_counts");
  EXPECT_EQ(norms.front(), 4);
  EXPECT_EQ(norms.back(), 2);
  EXPECT_EQ(std::accumulate(norms.begin(), norms.end(), 0), 6);
  EXPECT_EQ(json.at("norms_above"), 4);
  const std::vector<int> weights = json.at("weight_counts");
  EXPECT_EQ(weights.front(), 4);
  EXPECT_EQ(weights[10], 2);
  EXPECT_EQ(weights.back(), 4);
  EXPECT_EQ(json.at("weights_zero"), 4);
  EXPECT_EQ(json.at("degrees_counts"), nlohmann::json({0, 0, 2, 8, 0, 0, 0}));
}

}  // namespace
}  // namespace rgbd_pose
