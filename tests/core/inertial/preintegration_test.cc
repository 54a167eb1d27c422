#include "core/inertial/preintegration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/factors/rotations.h"
#include "core/factors/sampler.h"
#include "core/geometry/rigid3.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/imu_path.h"

namespace rgbd_pose {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;

const ImuBiasVector kBias = [] {
  ImuBiasVector bias;
  bias << 0.02, -0.03, 0.01, 0.1, 0.2, -0.15;
  return bias;
}();

// What `other` is more than `motion`: [omega v p].
Vector9 Difference(const PreintegratedMotion& other,
                   const PreintegratedMotion& motion) {
  Vector9 d;
  d << RotationVector(motion.start_from_end.conjugate() * other.start_from_end),
      other.v - motion.v, other.p - motion.p;
  return d;
}

// The motion along a path as PreintegratedMotion defines it.
PreintegratedMotion Exact(const ImuPath& path, double from, double to) {
  const PoseOf<double> i = path.Pose(from), j = path.Pose(to);
  const Eigen::Quaterniond to_i = i.q.conjugate();
  const double t = to - from;
  PreintegratedMotion motion;
  motion.seconds = t;
  motion.start_from_end = to_i * j.q;
  motion.v =
      to_i * (path.Velocity(to) - path.Velocity(from) - t * path.gravity);
  motion.p =
      to_i * (j.p - i.p - t * path.Velocity(from) - 0.5 * t * t * path.gravity);
  return motion;
}

// Twice the rate: a quarter of the error.
TEST(PreintegrationTest, FollowsAnExactPathToSecondOrder) {
  const ImuPath path;
  const PreintegratedMotion exact = Exact(path, 0.2, 1.2);
  double before = 0.0;
  for (const double rate : {100.0, 200.0, 400.0}) {
    const PreintegratedMotion motion = Preintegrate(
        path.Samples(0.2, 1.2, rate), ImuBiasVector::Zero(), ImuNoise());
    EXPECT_NEAR(motion.seconds, 1.0, 1e-12);
    const double error = Difference(motion, exact).norm();
    // A second at 200 Hz: measured 0.4 mm, mm/s and mrad together.
    EXPECT_LT(error, 1e-3 * std::pow(200.0 / rate, 2.0));
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 4.0, 0.2);
    }
    before = error;
  }
}

TEST(PreintegrationTest, TakesTheBiasOff) {
  std::vector<ImuSample> samples = ImuPath().Samples(0.0, 0.5, 200.0);
  const auto without = Preintegrate(samples, ImuBiasVector::Zero(), ImuNoise());
  for (ImuSample& sample : samples) {
    sample.gyro += kBias.head<3>();
    sample.accel += kBias.tail<3>();
  }
  const auto with = Preintegrate(samples, kBias, ImuNoise());
  EXPECT_LT(Difference(with, without).norm(), 1e-13);
  EXPECT_EQ(with.bias, kBias);
}

// Compares the derivatives with differences of the sum itself.
void ExpectDerivativesOfTheSum(const std::vector<ImuSample>& samples) {
  const auto motion = Preintegrate(samples, kBias, ImuNoise());
  constexpr double kStep = 1e-4;
  for (int k = 0; k < 6; ++k) {
    ImuBiasVector more = kBias, less = kBias;
    more[k] += kStep;
    less[k] -= kStep;
    const Vector9 by_difference =
        (Difference(Preintegrate(samples, more, ImuNoise()), motion) -
         Difference(Preintegrate(samples, less, ImuNoise()), motion)) /
        (2.0 * kStep);
    EXPECT_LT((by_difference - motion.by_bias.col(k)).norm(), 1e-8) << k;
  }
}

// Coarse samples of a fast motion, where approximate derivatives would differ.
TEST(PreintegrationTest, DerivativesByTheBiasAreThoseOfTheSum) {
  ExpectDerivativesOfTheSum(ImuPath().Samples(0.0, 0.5, 40.0));
}

// Half a radian and more between two samples, where series for small angles
// would differ.
TEST(PreintegrationTest, DerivativesByTheBiasHoldForLargeTurns) {
  FactorSampler random(1);
  std::vector<ImuSample> samples;
  for (int k = 0; k < 5; ++k) {
    const Eigen::Vector3d gyro =
        Eigen::Vector3d(12.0, -9.0, 6.0) + random.Vector<3>(2.0);
    samples.push_back({0.05 * k, gyro, random.Vector<3>(10.0)});
  }
  ExpectDerivativesOfTheSum(samples);
}

// A step at a constant rate, on both sides of where the series for small turns
// takes over: differences are too coarse to see its last terms.
TEST(PreintegrationTest, DerivativesByTheBiasHoldForSmallTurns) {
  constexpr double kSeconds = 0.5;
  constexpr double kSeries = 1e-12;  // what its first left out term may be
  FactorSampler random(2);
  for (const double angle : {0.0, 1e-4, 0.9e-2, 0.999e-2, 1.001e-2, 0.03}) {
    const Eigen::Vector3d turn = angle * random.Vector<3>(1.0).normalized();
    const ImuSample from = {0.0, turn / kSeconds, Eigen::Vector3d::Zero()};
    ImuSample to = from;
    to.stamp = kSeconds;
    const Eigen::Matrix3d by_gyro =
        Preintegrate({from, to}, ImuBiasVector::Zero(), ImuNoise())
            .by_bias.topLeftCorner<3, 3>();
    EXPECT_LT((by_gyro + kSeconds * RotationByJacobian(turn)).norm(), kSeries)
        << angle;
  }
}

// A bias that is half as far off leaves a quarter of the error.
TEST(PreintegrationTest, TheBiasCorrectionIsOfSecondOrder) {
  const auto samples = ImuPath().Samples(0.0, 1.0, 200.0);
  const auto motion = Preintegrate(samples, kBias, ImuNoise());
  ImuBiasVector step;
  step << 0.04, 0.05, -0.03, 0.2, -0.3, 0.1;
  double before = 0.0;
  for (const double part : {1.0, 0.5, 0.25}) {
    const Vector9 change = Difference(
        Preintegrate(samples, kBias + part * step, ImuNoise()), motion);
    const double error = (change - motion.by_bias * (part * step)).norm();
    EXPECT_LT(error, 0.05 * change.norm());
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 4.0, 0.2);
    }
    before = error;
  }
}

// Two parts in a row are the whole, also where a part ends between samples.
TEST(PreintegrationTest, PartsMakeUpTheWhole) {
  ImuBuffer buffer;
  for (const ImuSample& sample : ImuPath().Samples(0.0, 1.0, 200.0)) {
    buffer.Add(sample);
  }
  const auto part = [&](double from, double to) {
    return Preintegrate(buffer.Between(from, to), kBias, ImuNoise());
  };
  const PreintegratedMotion whole = part(0.1, 0.9);
  const PreintegratedMotion a = part(0.1, 0.4512), b = part(0.4512, 0.9);
  PreintegratedMotion both;
  both.start_from_end = a.start_from_end * b.start_from_end;
  both.v = a.v + a.start_from_end * b.v;
  both.p = a.p + b.seconds * a.v + a.start_from_end * b.p;
  // One step is cut in two, which changes its error of second order.
  EXPECT_LT(Difference(both, whole).norm(), 1e-6);
}

// Walks that are large against the noise: their correlation with the motion
// counts. 1,000 runs determine the mean NEES to 0.6 %.
TEST(PreintegrationTest, CovarianceHoldsInAThousandRuns) {
  constexpr double kRate = 200.0, kFrom = 0.0, kTo = 0.5;
  const ImuPath path;
  const PreintegratedMotion exact = Exact(path, kFrom, kTo);
  const auto samples = path.Samples(kFrom, kTo, kRate);
  const PreintegratedMotion discrete =
      Preintegrate(samples, ImuBiasVector::Zero(), ImuNoise());
  const Vector9 discretisation = Difference(discrete, exact);
  for (const ImuNoise& noise :
       {ImuNoise{3e-4, 2e-3, 2e-5, 3e-4}, ImuNoise{3e-4, 2e-3, 2e-3, 2e-2}}) {
    constexpr int kRuns = 1000;
    double nees = 0.0, nees_of_motion = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      ImuErrors errors(noise, kBias, run);
      const PreintegratedMotion motion =
          Preintegrate(errors.On(samples, kRate), kBias, noise);
      Eigen::Matrix<double, 15, 1> e;
      e << Difference(exact, motion) + discretisation, errors.bias() - kBias;
      nees += (motion.SqrtInformation() * e).squaredNorm() / 15.0 / kRuns;
      nees_of_motion +=
          e.head<9>().dot(motion.covariance.topLeftCorner<9, 9>().llt().solve(
              e.head<9>())) /
          9.0 / kRuns;
    }
    EXPECT_NEAR(nees, 1.0, 0.1);
    EXPECT_NEAR(nees_of_motion, 1.0, 0.1);
  }
}

// One step of white noise in continuous time: the integrals of its variance,
// density^2, which leave v and p apart.
TEST(PreintegrationTest, OneStepHasTheNoiseOfContinuousTime) {
  constexpr double kTime = 0.005;
  const ImuNoise noise;
  const auto motion = Preintegrate(
      {{0.0, {0, 0, 0}, {0, 0, 9.8}}, {kTime, {0, 0, 0}, {0, 0, 9.8}}},
      ImuBiasVector::Zero(), noise);
  const double accel = std::pow(noise.accel_density, 2.0);
  const auto& P = motion.covariance;
  EXPECT_NEAR(P(0, 0), std::pow(noise.gyro_density, 2.0) * kTime, 1e-18);
  EXPECT_NEAR(P(3, 3), accel * kTime, 1e-18);
  EXPECT_NEAR(P(3, 6), accel * std::pow(kTime, 2.0) / 2.0, 1e-20);
  EXPECT_NEAR(P(6, 6), accel * std::pow(kTime, 3.0) / 3.0, 1e-22);
  const auto S = motion.SqrtInformation();
  EXPECT_TRUE((S * P * S.transpose()).isIdentity(1e-9));
}

TEST(PreintegrationTest, BadInputIsOneLine) {
  const auto samples = ImuPath().Samples(0.0, 0.1, 100.0);
  const auto preintegrate = [](const std::vector<ImuSample>& some,
                               const ImuNoise& noise = {}) {
    Preintegrate(some, ImuBiasVector::Zero(), noise);
  };
  ExpectInputError([&] { preintegrate({samples[0]}); },
                   {"two moments or more", "not 1"});
  ExpectInputError(
      [&] {
        preintegrate({samples[1], samples[0]});
      },
      {"must increase: 0.000000 s follows 0.010000 s"});
  auto bad = samples;
  bad[3].stamp = NAN;
  ExpectInputError([&] { preintegrate(bad); }, {"must increase"});
  ImuNoise noise;
  noise.accel_walk = 0.0;
  ExpectInputError([&] { preintegrate(samples, noise); },
                   {"must be above 0, not 0"});
  bad = samples;
  bad[3].accel[0] = NAN;
  const auto motion = Preintegrate(bad, ImuBiasVector::Zero(), ImuNoise());
  ExpectInputError([&] { motion.SqrtInformation(); },
                   {"not finite", "check its samples"});
  ExpectInputError([] { PreintegratedMotion().SqrtInformation(); },
                   {"positive definite"});
}

}  // namespace
}  // namespace rgbd_pose
