#include "costs/factors/gyroscope.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/imu_path.h"

namespace rgbd_pose {
namespace {

// 1,000 runs of noise, with a bias that is not the one of the integration; the
// accelerometer measures nonsense. Poses in a world of their own.
TEST(GyroscopeFactorTest, IsOneSigmaAtTheTruth) {
  constexpr double kRate = 200.0;
  constexpr int kRuns = 1000;
  const ImuPath path;
  const ImuNoise noise = {1e-3, 1e3, 1e-7, 1e-7};
  ImuBiasVector bias = ImuBiasVector::Zero();
  bias.head<3>() << 0.01, -0.02, 0.01;
  const auto samples = path.Samples(0.0, 0.2, kRate);
  double chi2 = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    ImuErrors errors(noise, bias, run);
    const GyroscopeFactor factor(
        Preintegrate(errors.On(samples, kRate), ImuBiasVector::Zero(), noise));
    Eigen::Vector3d r;
    factor.Residual(path.Pose(0.0), path.Pose(0.2),
                    Eigen::Vector3d(bias.head<3>()), r.data());
    chi2 += r.squaredNorm();
  }
  EXPECT_NEAR(chi2 / (3.0 * kRuns), 1.0, 0.1);
}

TEST(GyroscopeFactorTest, RefusesWhatHasNoCovariance) {
  ExpectInputError([] { GyroscopeFactor{PreintegratedMotion()}; },
                   {"not positive definite"});
}

}  // namespace
}  // namespace rgbd_pose
