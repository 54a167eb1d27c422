#include "core/factors/relative_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/factors/factor.h"
#include "core/factors/sampler.h"

namespace rgbd_pose {
namespace {

// For any error below a half turn, the residual is 2 sin(angle / 2) along the
// axis of the error, about the axes of `cur`, not along the opposite axis.
TEST(RelativePoseFactorTest, GrowsUpToAHalfTurn) {
  FactorSampler random(2);
  for (const double angle : {0.01, 1.0, 2.0, 2.6, 3.1}) {
    for (int i = 0; i < 20; ++i) {
      const Rigid3d ref = random.Motion(), cur = random.Motion();
      const Eigen::Vector3d axis = random.Vector<3>(1.0).normalized();
      const Rigid3d cur_from_ref = cur.Inverse() * ref;
      const Rigid3d measured(
          Eigen::AngleAxisd(-angle, axis) * cur_from_ref.rotation,
          cur_from_ref.translation);
      MotionVector r;
      RelativePoseFactor{measured, MotionMatrix::Identity()}.Residual(
          PoseFrom(ref), PoseFrom(cur), r.data());
      EXPECT_TRUE(
          r.head<3>().isApprox(2.0 * std::sin(angle / 2.0) * axis, 1e-7))
          << angle << ": " << r.transpose() << ", axis " << axis.transpose();
    }
  }
}

// The covariance is in the axes of MotionEstimate's.
TEST(RelativePoseFactorTest, IsTheMahalanobisDistance) {
  FactorSampler random(3);
  for (int i = 0; i < 20; ++i) {
    const Rigid3d ref = random.Motion(), cur = random.Motion();
    const Rigid3d measured =
        Rigid3d::FromRotationVector(random.Vector<3>(1e-4),
                                    random.Vector<3>(0.1)) *
        cur.Inverse() * ref;
    const MotionMatrix S = random.SqrtInformation<6>();
    MotionVector r;
    RelativePoseFactor{measured, S}.Residual(PoseFrom(ref), PoseFrom(cur),
                                             r.data());
    const double squared = SquaredMahalanobisDistance(
        cur.Inverse() * ref, measured, (S.transpose() * S).inverse());
    EXPECT_NEAR(r.squaredNorm(), squared, 1e-9 * squared);
  }
}

// Ceres 2.2 writes to stderr where a cost that was evaluated is infinite.
TEST(RelativePoseFactorTest, AnInfiniteCostCannotBeEvaluated) {
  const std::unique_ptr<ceres::CostFunction> function(
      MakeFactor(RelativePoseFactor{Rigid3d(), MotionMatrix::Identity()}));
  for (const double metres : {1e100, 1e200}) {
    const Rigid3d far(Eigen::Quaterniond::Identity(), {metres, 0.0, 0.0});
    const PoseVector ref = PoseVectorOf(Rigid3d()), cur = PoseVectorOf(far);
    double const* const blocks[] = {ref.data(), cur.data()};
    double r[6], J[6 * 7];
    double* jacobians[] = {nullptr, J};
    const bool has_cost = metres < 1e150;
    EXPECT_EQ(function->Evaluate(blocks, r, nullptr), has_cost) << metres;
    EXPECT_EQ(function->Evaluate(blocks, r, jacobians), has_cost) << metres;
  }
}

}  // namespace
}  // namespace rgbd_pose
