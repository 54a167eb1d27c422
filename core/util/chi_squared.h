#pragma once

#include <algorithm>

namespace rgbd_pose {

// Quantiles of the chi-squared distribution with 1 to 6 degrees of freedom. The
// squared norm of the whitened residual of an inlier follows this distribution.
constexpr double ChiSquaredMedian(int degrees) {
  constexpr double kMedian[] = {0.454936, 1.386294, 2.365974,
                                3.356694, 4.351460, 5.348121};
  return kMedian[std::clamp(degrees, 1, 6) - 1];
}
constexpr double ChiSquared99(int degrees) {
  constexpr double k99[] = {6.634897,  9.210340,  11.344867,
                            13.276704, 15.086272, 16.811894};
  return k99[std::clamp(degrees, 1, 6) - 1];
}

}  // namespace rgbd_pose
