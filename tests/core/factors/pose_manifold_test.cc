#include "core/factors/pose_manifold.h"

#include <ceres/covariance.h>
#include <ceres/gradient_checker.h>
#ifndef RGBD_POSE_LOCAL_PARAMETERIZATION
#include <ceres/product_manifold.h>
#endif
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "core/factors/factor.h"
#include "core/factors/relative_pose.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

#ifndef RGBD_POSE_LOCAL_PARAMETERIZATION
TEST(PoseManifoldTest, StepsGoBackAndForth) {
  FactorSampler random(1);
  const PoseManifold manifold;
  for (int i = 0; i < 20; ++i) {
    const PoseVector x = PoseBlock::Random(&random);
    const MotionVector d = random.Vector<6>(1.5);
    PoseVector y;
    ASSERT_TRUE(manifold.Plus(x.data(), d.data(), y.data()));
    MotionVector back;
    ASSERT_TRUE(manifold.Minus(y.data(), x.data(), back.data()));
    EXPECT_TRUE(back.isApprox(d, 1e-12));
    Eigen::Matrix<double, 7, 6, Eigen::RowMajor> plus;
    Eigen::Matrix<double, 6, 7, Eigen::RowMajor> minus;
    ASSERT_TRUE(manifold.PlusJacobian(x.data(), plus.data()));
    ASSERT_TRUE(manifold.MinusJacobian(x.data(), minus.data()));
    EXPECT_TRUE((minus * plus).isIdentity(1e-14));
  }
}
#endif

TEST(PoseManifoldTest, HoldsDirections) {
  FactorSampler random(2);
  const PoseManifold planar({0, 2, 4});
  PoseVector x = PoseBlock::Random(&random), y;
  const double step[] = {0.2, 1.0, 3.0};
  ASSERT_TRUE(planar.Plus(x.data(), step, y.data()));
  MotionVector expected;
  expected << 0.0, 0.2, 0.0, 1.0, 0.0, 3.0;
  EXPECT_TRUE(PoseBlock::Minus(y.data(), x.data()).isApprox(expected, 1e-14));
  EXPECT_THROW(PoseManifold({6}), InputError);
}

class PoseProblemTest : public testing::Test {
 protected:
  // Between two poses, far from half a turn, where the residual jumps.
  void Draw() {
    ref_ = PoseBlock::Random(&random_);
    cur_ = PoseBlock::Random(&random_);
    factor_ = RelativePoseFactor::Sample(&random_);
    factor_.cur_from_ref =
        Rigid3d::FromRotationVector({0.5, -0.8, 0.3}, {0.2, 0.1, 0.4}) *
        RigidOf(cur_).Inverse() * RigidOf(ref_);
  }

  FactorSampler random_{4};
  PoseVector ref_, cur_;
  RelativePoseFactor factor_;
};

// Also on Ceres' own manifold, which turns about the axes of the world.
TEST_F(PoseProblemTest, PassesCeresGradientChecker) {
  const PoseManifold pose, held({1, 3});
#ifdef RGBD_POSE_LOCAL_PARAMETERIZATION
  const ceres::ProductParameterization theirs(
      new ceres::EigenQuaternionParameterization(),
      new ceres::IdentityParameterization(3));
#else
  const ceres::ProductManifold<ceres::EigenQuaternionManifold,
                               ceres::EuclideanManifold<3>>
      theirs;
#endif
  for (int i = 0; i < 20; ++i) {
    Draw();
    const std::unique_ptr<ceres::CostFunction> factor(MakeFactor(factor_));
    const double* x[] = {ref_.data(), cur_.data()};
    for (const auto& manifolds :
         {std::vector<const CeresManifold*>{&pose, &held},
          std::vector<const CeresManifold*>{&theirs, &theirs}}) {
      ceres::GradientChecker::ProbeResults results;
      EXPECT_TRUE(ceres::GradientChecker(factor.get(), &manifolds, {})
                      .Probe(x, 1e-7, &results))
          << results.error_log;
    }
  }
}

// One motion from a fixed pose: the pose is as uncertain as the motion.
TEST_F(PoseProblemTest, CovarianceIsThatOfAMotionEstimate) {
  const MotionMatrix S = random_.SqrtInformation<6>();
  PoseVector world = PoseVectorOf(Rigid3d());
  PoseVector pose = PoseBlock::Random(&random_);
  ceres::Problem problem;
  AddPose(world.data(), &problem);
  AddPose(pose.data(), &problem);
  problem.SetParameterBlockConstant(world.data());
  problem.AddResidualBlock(
      MakeFactor(RelativePoseFactor{RigidOf(pose).Inverse(), S}), nullptr,
      world.data(), pose.data());
  ceres::Covariance covariance({});
  ASSERT_TRUE(
      covariance.Compute(std::vector<const double*>{pose.data()}, &problem));
  MotionMatrix block;
  covariance.GetCovarianceBlockInTangentSpace(pose.data(), pose.data(),
                                              block.data());
  EXPECT_TRUE(
      PoseCovariance(block).isApprox((S.transpose() * S).inverse(), 1e-10));
}

}  // namespace
}  // namespace rgbd_pose
