#include "costs/factors/inertial.h"

#include <gtest/gtest.h>

#include "core/factors/sampler.h"
#include "tests/support/imu_path.h"

namespace rgbd_pose {
namespace {

using Residual = Eigen::Matrix<double, 15, 1>;

// A factor along a path at the true states; biases at both ends.
Residual AtTruth(const InertialFactor& factor, const ImuPath& path, double from,
                 double to, const ImuBiasVector& b_i,
                 const ImuBiasVector& b_j) {
  Residual r;
  factor.Residual(path.Pose(from), path.Velocity(from), b_i, path.Pose(to),
                  path.Velocity(to), b_j, r.data());
  return r;
}

// A rotation that is a little off, and one that is off by half a turn, come
// back: 2 vec q keeps the sign of the shorter rotation.
TEST(InertialFactorTest, RotationGrowsUpToAHalfTurn) {
  FactorSampler random(2);
  InertialFactor factor = InertialFactor::Sample(&random);
  factor.sqrt_information.setIdentity();
  const ImuBiasVector bias = factor.motion.bias;
  const Eigen::Vector3d v(0, 0, 0), axis = random.Vector<3>(1.0).normalized();
  for (const double angle : {0.01, 1.0, 2.6, 3.1}) {
    const PoseOf<double> i = PoseFrom(random.Motion());
    const PoseOf<double> j = {
        i.q * factor.motion.start_from_end * Eigen::AngleAxisd(angle, axis),
        i.p};
    Residual r;
    factor.Residual(i, v, bias, j, v, bias, r.data());
    EXPECT_TRUE(r.head<3>().isApprox(2.0 * std::sin(angle / 2.0) * axis, 1e-7));
  }
}

// The whitened residual at the true states, over poses, velocities, biases and
// gravity: 300 runs with errors of a sensor whose walk counts, integrated
// with a bias that is not the true one.
TEST(InertialFactorTest, IsOneSigmaAtTheTruth) {
  constexpr double kRate = 200.0, kFrom = 0.3, kTo = 0.8;
  constexpr int kRuns = 300;
  const ImuPath path;
  const ImuNoise noise = {3e-4, 2e-3, 2e-3, 2e-2};
  ImuBiasVector bias, assumed;
  bias << 0.01, -0.02, 0.01, 0.1, 0.2, -0.15;
  assumed << 0.011, -0.021, 0.012, 0.12, 0.19, -0.14;
  const auto samples = path.Samples(kFrom, kTo, kRate);
  // What the sum lacks without any noise.
  const Residual offset = AtTruth(
      InertialFactor(Preintegrate(samples, ImuBiasVector::Zero(), noise),
                     path.gravity),
      path, kFrom, kTo, ImuBiasVector::Zero(), ImuBiasVector::Zero());
  EXPECT_LT(offset.norm(), 1.5);
  double chi2 = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    ImuErrors errors(noise, bias, run);
    const InertialFactor factor(
        Preintegrate(errors.On(samples, kRate), assumed, noise), path.gravity);
    chi2 += (AtTruth(factor, path, kFrom, kTo, bias, errors.bias()) - offset)
                .squaredNorm();
  }
  EXPECT_NEAR(chi2 / (15.0 * kRuns), 1.0, 0.1);
}

// A bias that is not the one of the integration is corrected: without the
// correction the residual would be 100 times as large.
TEST(InertialFactorTest, CorrectsTheBias) {
  const ImuPath path;
  const auto samples = path.Samples(0.0, 0.2, 1000.0);
  ImuBiasVector bias;
  bias << 0.003, -0.002, 0.004, 0.02, 0.03, -0.02;
  ImuErrors errors({1e-12, 1e-12, 1e-12, 1e-12}, bias, 1);
  InertialFactor factor(Preintegrate(errors.On(samples, 1000.0),
                                     ImuBiasVector::Zero(), ImuNoise()),
                        path.gravity);
  factor.sqrt_information.setIdentity();
  const double uncorrected =
      AtTruth(factor, path, 0.0, 0.2, ImuBiasVector::Zero(),
              ImuBiasVector::Zero())
          .norm();
  const double corrected = AtTruth(factor, path, 0.0, 0.2, bias, bias).norm();
  EXPECT_GT(uncorrected, 5e-3);
  EXPECT_LT(corrected, 0.01 * uncorrected);
}

}  // namespace
}  // namespace rgbd_pose
