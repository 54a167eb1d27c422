// Compares every hand-written Jacobian with ceres::Jet, exactly. Finite
// differences would hide a small wrong term.

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/geometry/motion.h"
#include "costs/cost_list.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/both_jacobians.h"

namespace rgbd_pose {
namespace {

// Rounding of some tens of operations, relative to the largest entry of the
// row, because a row mixes terms of very different sizes that may cancel.
constexpr double kJacobianTolerance = 1e-12;
constexpr int kJacobianSamples = 1000;

template <typename Residual>
class JacobianTest : public ::testing::Test, protected BothJacobians<Residual> {
 protected:
  using BothJacobians<Residual>::EvaluateBoth;
  void EvaluateBoth(const ResidualSample<Residual>& sample) {
    EvaluateBoth(sample.origin, sample.x, sample.columns);
  }
};

TYPED_TEST_SUITE(JacobianTest, AsGTestTypes<ResidualTypes>::type, CostName);

TYPED_TEST(JacobianTest, EqualsTheOracleRowByRow) {
  RandomWorld world(1);
  int telling[TypeParam::kRows] = {};  // samples where the row is not zero
  for (int i = 0; i < kJacobianSamples; ++i) {
    this->EvaluateBoth(ResidualSample<TypeParam>(&world));
    for (int row = 0; row < TypeParam::kRows; ++row) {
      const double scale = std::max(1.0, std::abs(this->jet_r_[row]));
      EXPECT_NEAR(this->hand_r_[row], this->jet_r_[row],
                  kJacobianTolerance * scale);
      EXPECT_LE(this->RowError(row, 0, 6), kJacobianTolerance)
          << TypeParam::kName << " row " << row << ", sample " << i;
      if (this->jet_J_.row(row).norm() > 1e-6) ++telling[row];
    }
  }
  for (int row = 0; row < TypeParam::kRows; ++row) {
    EXPECT_GE(telling[row], kJacobianSamples / 2)
        << "vacuous samples, row " << row;
  }
}

// The thesis' tables by number, with their block of rows and columns: a failure
// names the table to check.
struct Table {
  const char* name;
  int row;
  int first_column;
  int columns;
};

using BidirectionalPointTest = JacobianTest<BidirectionalPoint>;

TEST_F(BidirectionalPointTest, EqualsTheOracleTableByTable) {
  const Table tables[] = {
      {"Table 2.3, current x error", 0, 0, 3},
      {"Table 2.4, current y error", 1, 0, 3},
      {"Table 2.5, current z error", 2, 0, 3},
      {"Table 2.6, previous x error", 3, 0, 3},
      {"Table 2.7, previous y error", 4, 0, 3},
      {"Table 2.8, previous z error", 5, 0, 3},
      {"Table 2.9, C columns of current x", 0, 3, 3},
      {"Table 2.9, C columns of current y", 1, 3, 3},
      {"Table 2.9, C columns of current z", 2, 3, 3},
      {"Table 2.9, C columns of previous x", 3, 3, 3},
      {"Table 2.9, C columns of previous y", 4, 3, 3},
      {"Table 2.9, C columns of previous z", 5, 3, 3},
  };
  RandomWorld world(2);
  for (int i = 0; i < kJacobianSamples; ++i) {
    EvaluateBoth(ResidualSample<BidirectionalPoint>(&world));
    for (const Table& table : tables) {
      EXPECT_LE(RowError(table.row, table.first_column, table.columns),
                kJacobianTolerance)
          << table.name << ", sample " << i;
    }
  }
}

// With unit whitening on the optical axis (a = b = 0), the rows are the plain
// errors of the tables, here written with matrices.
TEST_F(BidirectionalPointTest, RowsAreTheThesisErrors) {
  const Eigen::Vector3d prev(0.0, 0.0, 1.5), cur(0.0, 0.0, 2.0);
  const double columns[] = {0, 0, prev.z(), 1, 1, 1, 0, 0, cur.z(), 1, 1, 1};
  MotionVector x;
  x << 0.2, -0.1, 0.3, 0.05, -0.02, 0.07;
  double r[6], J[6][6];
  const MotionDerivatives motion = LinearizationPoint().DerivativesAt(x.data());
  BidirectionalPoint::Jacobian(motion, columns, r, J);
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(-0.1, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  const Eigen::Vector3d C = x.tail<3>();
  const Eigen::Vector3d e_c = cur - R * (prev - C);
  const Eigen::Vector3d e_p = prev - (R.transpose() * cur + C);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(r[i], e_c[i], kJacobianTolerance);
    EXPECT_NEAR(r[3 + i], e_p[i], kJacobianTolerance);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(J[i][3 + k], R(i, k), kJacobianTolerance);
      EXPECT_EQ(J[3 + i][3 + k], i == k ? -1.0 : 0.0);
    }
  }
}

}  // namespace
}  // namespace rgbd_pose
