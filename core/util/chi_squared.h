#pragma once

namespace rgbd_pose {

// Quantiles of the chi-squared distribution with 1 <= degrees <= 6 degrees of
// freedom: what the squared norm of a right match's whitened residual follows.
double ChiSquaredMedian(int degrees);
double ChiSquared99(int degrees);

}  // namespace rgbd_pose
