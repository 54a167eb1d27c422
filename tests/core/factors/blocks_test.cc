// The tangent of a pose, and Jacobians by its numbers.

#include "core/factors/blocks.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "core/factors/factor.h"
#include "core/factors/relative_pose.h"

namespace rgbd_pose {
namespace {

TEST(PoseBlockTest, GoesToARigidMotionAndBack) {
  FactorSampler random(1);
  const Rigid3d pose = random.Motion();
  EXPECT_TRUE(RigidOf(PoseVectorOf(pose)) == pose);
}

TEST(PoseBlockTest, PlusTurnsAboutTheBodysAxesAndMovesAlongTheWorlds) {
  FactorSampler random(2);
  const Rigid3d pose = random.Motion();
  Eigen::Matrix<double, 6, 1> d;
  d << 0.3, -0.2, 0.5, 1.0, 2.0, 3.0;
  PoseVector moved;
  PoseBlock::Plus(PoseVectorOf(pose).data(), d.data(), moved.data());
  const Rigid3d turn = Rigid3d::FromRotationVector(d.head<3>(), {0, 0, 0});
  EXPECT_TRUE(
      RigidOf(moved).rotation.isApprox(pose.rotation * turn.rotation, 1e-15));
  EXPECT_TRUE(moved.tail<3>().isApprox(pose.translation + d.tail<3>(), 1e-15));
}

TEST(PoseBlockTest, LiftIsTheInverseOfPlusInTheTangent) {
  FactorSampler random(3);
  TangentJacobian<2, PoseBlock> by;
  for (double& value : by.reshaped()) value = random.Uniform(-1.0, 1.0);
  const PoseVector x = PoseBlock::Random(&random);
  Eigen::Matrix<double, 2, 7, Eigen::RowMajor> lifted;
  PoseBlock::Lift<2>(by, x.data(), lifted.data());
  EXPECT_TRUE((lifted * PoseBlock::PlusJacobian(x.data())).isApprox(by, 1e-14));
}

class PoseJacobianTest : public testing::Test {
 protected:
  // A factor far from half a turn, where its residual jumps.
  void Draw() {
    ref_ = PoseBlock::Random(&random_);
    cur_ = PoseBlock::Random(&random_);
    factor_ = RelativePoseFactor::Sample(&random_);
    factor_.cur_from_ref =
        Rigid3d::FromRotationVector({0.5, -0.8, 0.3}, {0.2, 0.1, 0.4}) *
        RigidOf(cur_).Inverse() * RigidOf(ref_);
  }

  using Rows = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;
  std::array<Rows, 2> JacobiansOf(ceres::CostFunction* function) const {
    const std::unique_ptr<ceres::CostFunction> owned(function);
    std::array<Rows, 2> J;
    MotionVector r;
    const double* x[] = {ref_.data(), cur_.data()};
    double* jacobians[] = {J[0].data(), J[1].data()};
    EXPECT_TRUE(function->Evaluate(x, r.data(), jacobians));
    return J;
  }

  FactorSampler random_{4};
  PoseVector ref_, cur_;
  RelativePoseFactor factor_;
};

// All 7 columns are those of the normalised quaternion, of any length: so they
// are right for every manifold, and for none.
TEST_F(PoseJacobianTest, IsThatOfTheNormalisedQuaternion) {
  for (const double length : {1.0, 0.3, 4.0}) {
    Draw();
    ref_.head<4>() *= length;
    cur_.head<4>() *= -length;
    const auto hand = JacobiansOf(MakeFactor(factor_));
    const auto jet = JacobiansOf(MakeAutodiffFactor(factor_));
    for (int pose = 0; pose < 2; ++pose) {
      EXPECT_TRUE(hand[pose].isApprox(jet[pose], 1e-13)) << length;
    }
  }
}

// Of a pose that nobody has set, and that the problem holds, Ceres asks for no
// Jacobian: the residual has to be refused.
TEST_F(PoseJacobianTest, NoRotationIsNoResidual) {
  Draw();
  ref_.head<4>().setZero();
  const std::unique_ptr<ceres::CostFunction> function(MakeFactor(factor_));
  const double* x[] = {ref_.data(), cur_.data()};
  MotionVector r;
  function->Evaluate(x, r.data(), nullptr);
  EXPECT_TRUE(r.head<3>().hasNaN());
  EXPECT_TRUE(PoseBlock::Read(ref_.data()).q.coeffs().hasNaN());
}

// A problem may hold a pose, of which Ceres then wants no Jacobian.
TEST_F(PoseJacobianTest, FillsInOnlyWhatIsWanted) {
  Draw();
  const auto both = JacobiansOf(MakeFactor(factor_));
  const std::unique_ptr<ceres::CostFunction> function(MakeFactor(factor_));
  const double* x[] = {ref_.data(), cur_.data()};
  Rows J;
  MotionVector r;
  double* jacobians[] = {nullptr, J.data()};
  ASSERT_TRUE(function->Evaluate(x, r.data(), jacobians));
  EXPECT_EQ(J, both[1]);
}

}  // namespace
}  // namespace rgbd_pose
