// Tests the covariances of direct costs on pairs of simulated frames.
// kInformation of the costs was chosen with this test.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <iterator>
#include <string>

#include "core/estimation/estimator.h"
#include "core/geometry/motion.h"
#include "costs/direct_cost_factory.h"
#include "tests/support/direct_pair.h"

namespace rgbd_pose {
namespace {

// A sixth of the squared error [omega C] in units of the covariance (NEES / 6).
// Its mean is 1 if the covariance is correct.
double Nees(const MotionEstimate& estimate, const Rigid3d& truth) {
  return SquaredMahalanobisDistance(estimate.cur_from_prev, truth,
                                    estimate.covariance) /
         6.0;
}

// A guess that converges: 1 cm and 0.3 degrees off, in varying directions.
Rigid3d Guess(const Rigid3d& truth, int i) {
  const Eigen::Vector3d way(i % 3 - 1, i % 5 - 2, i % 2 + 0.5);
  const Eigen::Vector3d axis(i % 7 - 3, i % 2 + 0.5, i % 3 - 1);
  return Rigid3d(
             Eigen::Quaterniond(Eigen::AngleAxisd(0.005, axis.normalized())),
             0.01 * way.normalized()) *
         truth;
}

TEST(DirectCovarianceTest, IsHonest) {
  const char* const costs[] = {"photometric", "projective_plane",
                               "inverse_depth", "photometric+projective_plane"};
  std::array<double, std::size(costs)> sums = {};
  std::array<std::string, std::size(costs)> of_paths;
  int pairs = 0;
  for (const char* path : {"xyz", "pan_tilt", "handheld"}) {
    SyntheticOptions options;
    options.path = path;
    std::array<double, std::size(costs)> sums_of_path = {};
    int pairs_of_path = 0;
    for (const uint32_t seed : {1, 2}) {
      options.seed = seed;
      const SyntheticDataset dataset(options);
      // One to three frames apart.
      for (int i = 0; i + 3 < options.frames; i += 15) {
        const DirectPair pair(dataset, i, i + 1 + i / 15 % 3);
        ++pairs_of_path;
        for (size_t k = 0; k < std::size(costs); ++k) {
          MotionEstimate estimate;
          Estimator(DirectEstimatorOptions(), MakeDirectCosts(costs[k]))
              .Estimate(pair.data(), Guess(pair.cur_from_prev, i), &estimate);
          ASSERT_FALSE(estimate.covariance.isZero())
              << costs[k] << ": " << estimate.reason;
          sums_of_path[k] += Nees(estimate, pair.cur_from_prev);
        }
      }
    }
    for (size_t k = 0; k < std::size(costs); ++k) {
      of_paths[k] += std::string(" ") + path + " " +
                     std::to_string(sums_of_path[k] / pairs_of_path);
      sums[k] += sums_of_path[k];
    }
    pairs += pairs_of_path;
  }
  for (size_t k = 0; k < std::size(costs); ++k) {
    const double mean = sums[k] / pairs;
    EXPECT_GT(mean, 0.75) << costs[k] << of_paths[k];
    EXPECT_LT(mean, 1.25) << costs[k] << of_paths[k];
    RecordProperty(costs[k], std::to_string(mean) + of_paths[k]);
  }
}

}  // namespace
}  // namespace rgbd_pose
