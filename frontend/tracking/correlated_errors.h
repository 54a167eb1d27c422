#pragma once

#include "core/estimation/correspondences.h"
#include "core/estimation/motion_estimate.h"

namespace rgbd_pose {

// Returns the factor, at least 1, by which the covariance of a motion is too
// small because errors of neighbouring features are alike: blur, acceleration
// within a frame and calibration displace them together. Compares the scatter
// of the gradients of whole cells of the image (a cluster-robust covariance:
// Liang & Zeger 1986) with that of single matches.
double CovarianceInflation(const Correspondences& matches,
                           const MotionEstimate& estimate);

}  // namespace rgbd_pose
