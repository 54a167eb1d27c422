#include "core/pose_graph/sparse_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace rgbd_pose {
namespace {

// J^T J with three random entries in each of `rows` rows.
Eigen::MatrixXd RandomInformation(int size, int rows) {
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> column(0, size - 1);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, size);
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < 3; ++i) J(row, column(engine)) += normal(engine);
  }
  return J.transpose() * J;
}

TEST(SparseInverseTest, IsTheInverseWhereTheMatrixHasEntries) {
  const Eigen::MatrixXd matrix = RandomInformation(50, 90);
  const Eigen::MatrixXd whole = matrix.inverse();
  const SparseInverse inverse(matrix.sparseView());
  ASSERT_TRUE(inverse.is_valid());
  int entries = 0;
  for (int i = 0; i < 50; ++i) {
    EXPECT_LT((inverse.Column(i) - whole.col(i)).norm(), 1e-12 * whole.norm());
    for (int k = 0; k < 50; ++k) {
      if (matrix(i, k) == 0.0) continue;
      ++entries;
      EXPECT_NEAR(inverse(i, k), whole(i, k), 1e-12 * whole.norm());
    }
  }
  EXPECT_GT(entries, 200);
  EXPECT_LT(entries, 1000);
}

TEST(SparseInverseTest, KnowsThatThereIsNone) {
  EXPECT_FALSE(
      SparseInverse(RandomInformation(50, 40).sparseView()).is_valid());
  Eigen::MatrixXd indefinite = Eigen::MatrixXd::Identity(3, 3);
  indefinite(0, 2) = indefinite(2, 0) = 2.0;
  EXPECT_FALSE(SparseInverse(indefinite.sparseView()).is_valid());
}

}  // namespace
}  // namespace rgbd_pose
