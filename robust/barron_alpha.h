#pragma once

#include <vector>

namespace rgbd_pose {

// The shape of Barron's loss (robust/barron_loss.h) under which residual norms
// are the most likely, by search over -4, -3.75 ... 2: the "adaptive" loss, as
// two steps: choose the shape from residuals, then estimate with it.
//
// `norms` are those of whitened residuals with 1 <= dimension <= 6 independent
// components; `width` is the loss's, in the same unit, and the sigma of normal
// noise. Normal norms give 2, the more there are far out the lower the result.
// No norms give 2.
//
// exp(-R(|r|^2) / (2 c^2)) is no density for low shapes, as its integral over
// all r is infinite; so it ends at 10 widths (Chebrolu et al., Adaptive Robust
// Kernels for Non-Linear Least Squares Problems, RA-L 2021), where farther
// norms are taken to lie.
double MostLikelyBarronAlpha(const std::vector<double>& norms, int dimension,
                             double width = 1.0);

}  // namespace rgbd_pose
