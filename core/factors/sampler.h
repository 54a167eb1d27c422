#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "core/geometry/rigid3.h"
#include "core/util/counter_random.h"

namespace rgbd_pose {

// Random states and measurements, at which the Jacobians of factors are
// checked: the same for a seed on every platform.
class FactorSampler {
 public:
  // The same seed gives the same numbers.
  explicit FactorSampler(uint64_t seed) : random_(seed) {}

  // A number in [low, high).
  double Uniform(double low, double high) {
    return low + (high - low) * std::ldexp(random_.Next() >> 11, -53);
  }

  // Each number in [-size, size).
  template <int N>
  Eigen::Matrix<double, N, 1> Vector(double size) {
    Eigen::Matrix<double, N, 1> v;
    for (double& value : v) value = Uniform(-size, size);
    return v;
  }

  // Any rotation, and a position (m) in the cube of -2 to 2.
  Rigid3d Motion();

  // The square root of an information with correlations, of about 1.
  template <int N>
  Eigen::Matrix<double, N, N> SqrtInformation() {
    Eigen::Matrix<double, N, N> S = Eigen::Matrix<double, N, N>::Identity();
    for (double& value : S.reshaped()) value += Uniform(-0.5, 0.5);
    return S;
  }

 private:
  CounterRandom random_;
};

}  // namespace rgbd_pose
