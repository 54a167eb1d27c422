#pragma once

#include <array>
#include <cstddef>

namespace rgbd_pose {

// The factors that make a scale estimator unbiased for few values: one for each
// n from 2 to 9, and n / (n + shift) above, with one shift for even and one for
// odd n. From Croux and Rousseeuw, Time-Efficient Algorithms for Two Highly
// Robust Estimators of Scale (COMPSTAT 1992); tests/robust/scale_test.cc
// confirms them by simulation.
struct SmallSample {
  std::array<double, 8> factors;  // for n = 2 ... 9
  double shift_even;
  double shift_odd;

  double Factor(size_t n) const {
    if (n < 10) return factors[n - 2];
    const double size = static_cast<double>(n);
    return size / (size + (n % 2 == 0 ? shift_even : shift_odd));
  }
};

}  // namespace rgbd_pose
