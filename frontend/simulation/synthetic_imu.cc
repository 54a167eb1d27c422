#include "frontend/simulation/synthetic_imu.h"

#include <cmath>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/simulation/synthetic_hash.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector3d;

const Vector3d kGravity(0.0, 0.0, -9.81);  // m/s^2, in the world

// What an exact sensor measures. Central differences of fourth order over the
// step h: their errors are h^4 times the fifth and sixth derivative of the
// path, and about 1e-15 / h^2 by rounding.
ImuSample Exact(const std::function<Rigid3d(double t)>& world_from_imu,
                double t) {
  constexpr double h = 1e-3;  // s
  const Rigid3d here = world_from_imu(t);
  Vector3d turn[4], shift[4];
  constexpr int kSteps[] = {-2, -1, 1, 2};
  for (int i = 0; i < 4; ++i) {
    const Rigid3d there = world_from_imu(t + kSteps[i] * h);
    turn[i] = RotationVector(here.rotation.conjugate() * there.rotation);
    shift[i] = there.translation - here.translation;
  }
  const Vector3d acceleration =
      (16.0 * (shift[1] + shift[2]) - shift[0] - shift[3]) / (12.0 * h * h);
  return {t, (8.0 * (turn[2] - turn[1]) - (turn[3] - turn[0])) / (12.0 * h),
          here.rotation.conjugate() * (acceleration - kGravity)};
}

// Normal numbers, three for each count.
class Noise {
 public:
  explicit Noise(uint32_t seed) : seed_(seed) {}

  Vector3d Next() {
    Vector3d v;
    for (double& value : v) {
      value = GaussianFromBits(
          HashCounter((static_cast<uint64_t>(seed_) << 32) + count_++));
    }
    return v;
  }

 private:
  const uint32_t seed_;
  uint64_t count_ = 0;
};

}  // namespace

std::string SyntheticImuOptions::Check() const {
  if (!(rate_hz > 0.0) || !(rate_hz <= 1e5)) {
    return Format("rate_hz of the inertial sensor must be in (0, 1e5], not %g",
                  rate_hz);
  }
  if (!(gyro_limit > 0.0) || !(accel_limit > 0.0)) {
    return "gyro_limit and accel_limit must be above 0";
  }
  if (!bias.allFinite() || !std::isfinite(delay_s) || !gyro_axes.allFinite() ||
      !accel_axes.allFinite() || !cam_from_imu.IsFinite()) {
    return "bias, delay, axes and mounting of the inertial sensor must be "
           "finite";
  }
  return noise ? densities.Check() : "";
}

std::vector<ImuSample> SimulateImu(
    const std::function<Rigid3d(double t)>& world_from_cam, double from,
    double to, const SyntheticImuOptions& options) {
  RequireSound(options.Check());
  const auto world_from_imu = [&](double t) {
    return world_from_cam(t) * options.cam_from_imu;
  };
  Noise random(options.seed);
  ImuBiasVector bias = options.bias;
  const double white = options.noise ? std::sqrt(options.rate_hz) : 0.0;
  const double walk = options.noise ? 1.0 / std::sqrt(options.rate_hz) : 0.0;
  const ImuNoise& noise = options.densities;
  std::vector<ImuSample> samples;
  const auto count =
      static_cast<int64_t>(std::floor((to - from) * options.rate_hz + 1e-6));
  for (int64_t k = 0; k <= count; ++k) {
    const double stamp = from + static_cast<double>(k) / options.rate_hz;
    ImuSample sample = Exact(world_from_imu, stamp - options.delay_s);
    sample.stamp = stamp;
    sample.gyro = options.gyro_axes * sample.gyro + bias.head<3>() +
                  white * noise.gyro_density * random.Next();
    sample.accel = options.accel_axes * sample.accel + bias.tail<3>() +
                   white * noise.accel_density * random.Next();
    sample.gyro =
        sample.gyro.cwiseMin(options.gyro_limit).cwiseMax(-options.gyro_limit);
    sample.accel = sample.accel.cwiseMin(options.accel_limit)
                       .cwiseMax(-options.accel_limit);
    bias.head<3>() += walk * noise.gyro_walk * random.Next();
    bias.tail<3>() += walk * noise.accel_walk * random.Next();
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace rgbd_pose
