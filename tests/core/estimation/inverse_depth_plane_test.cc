// Planes of inverse depth, compared with Eigen's least squares.

#include "core/estimation/inverse_depth_plane.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <vector>

namespace rgbd_pose {
namespace {

// Fits grids of which some pixels are missing.
template <int kSide>
void ExpectLeastSquares(int missing) {
  SCOPED_TRACE(missing);
  constexpr int kHalf = kSide / 2, kAll = kSide * kSide;
  std::mt19937 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<int> places(kAll);
    std::iota(places.begin(), places.end(), 0);
    std::shuffle(places.begin(), places.end(), random);
    const int count = kAll - missing;
    Eigen::MatrixXd rows(count, 3);
    Eigen::VectorXd right(count);
    InverseDepthGrid<kSide> grid;
    for (int k = 0; k < count; ++k) {
      const int column = places[k] % kSide - kHalf;
      const int row = places[k] / kSide - kHalf;
      rows.row(k) << 1.0, column, row;
      right[k] = std::uniform_real_distribution<>(0.3, 0.6)(random);
      grid.Add(column, row, right[k]);
    }
    EXPECT_FALSE(grid.Fit(count + 1).has_value());
    const std::optional<InverseDepthPlane> plane = grid.Fit(count);
    ASSERT_TRUE(plane.has_value());
    const Eigen::Vector3d expected = rows.colPivHouseholderQr().solve(right);
    for (const double column : {-1.0, 0.3}) {
      for (const double row : {0.0, 0.7}) {
        EXPECT_NEAR(plane->At(column, row),
                    expected.dot(Eigen::Vector3d(1.0, column, row)), 1e-12);
      }
    }
    // The variance of the middle is that of a pixel times this.
    const double variance = (rows.transpose() * rows).inverse()(0, 0);
    EXPECT_NEAR(plane->relative_sigma, std::sqrt(kAll * variance), 1e-12);
  }
}

TEST(InverseDepthPlaneTest, IsThatOfLeastSquares) {
  for (const int missing : {0, 1, 2, 3}) ExpectLeastSquares<3>(missing);
  for (const int missing : {0, 4, 8}) ExpectLeastSquares<5>(missing);
}

}  // namespace
}  // namespace rgbd_pose
