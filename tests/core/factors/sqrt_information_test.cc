#include "core/factors/sqrt_information.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/factors/sampler.h"
#include "core/geometry/motion.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

TEST(SqrtInformationTest, GivesTheInformationBack) {
  FactorSampler random(3);
  MotionMatrix half;
  for (int i = 0; i < 6; ++i) half.col(i) = random.Vector<6>(1.0);
  half.topRows<3>() *= 1e4;  // rad^-1 and m^-1
  MotionMatrix information = half * half.transpose();
  MotionMatrix root = SqrtInformation(information);
  EXPECT_TRUE((root.transpose() * root).isApprox(information, 1e-12));

  information.row(2).setZero();
  information.col(2).setZero();
  root = SqrtInformation(information);
  EXPECT_TRUE((root.transpose() * root).isApprox(information, 1e-12));

  information(2, 2) = -1e-17;  // by rounding
  root = SqrtInformation(information);
  EXPECT_TRUE((root.transpose() * root).isApprox(information, 1e-12));
  information(2, 2) = -1.0;
  EXPECT_TRUE(SqrtInformation(information).hasNaN());
}

TEST(SqrtInformationTest, OfACovarianceThatIsPositiveDefinite) {
  FactorSampler random(4);
  const Eigen::Matrix3d half = random.SqrtInformation<3>();
  const Eigen::Matrix3d covariance = half * half.transpose();
  const Eigen::Matrix3d S = SqrtInformationOfCovariance(covariance);
  EXPECT_TRUE((S.transpose() * S * covariance).isIdentity(1e-12));
  EXPECT_THROW(SqrtInformationOfCovariance(MotionMatrix::Zero()), InputError);
  EXPECT_THROW(SqrtInformationOfCovariance(-covariance), InputError);
  for (const double size : {1e-12, 1.0, 1e12}) {
    Eigen::Matrix2d crossed;
    crossed << size, 2.0 * size, 2.0 * size, size;
    EXPECT_THROW(SqrtInformationOfCovariance(crossed), InputError) << size;
    EXPECT_THROW(
        SqrtInformationOfCovariance(-size * Eigen::Matrix3d::Identity()),
        InputError)
        << size;
  }
  Eigen::Matrix3d skewed = Eigen::Matrix3d::Identity();
  skewed(0, 1) = 0.5;
  EXPECT_THROW(SqrtInformationOfCovariance(skewed), InputError);
  skewed(0, 1) = NAN;
  try {
    SqrtInformationOfCovariance(skewed);
    ADD_FAILURE() << "NaN is taken";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "a covariance is not finite");
  }
}

}  // namespace
}  // namespace rgbd_pose
