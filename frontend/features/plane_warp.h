#pragma once

#include <Eigen/Core>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// How the image around an observation (with a depth) is stretched and turned
// by a motion: d(pixel in cur) / d(pixel in ref) over the plane of its depth
// and normal, or parallel to the image if there is no normal or it is seen
// edge-on. The point must lie before both cameras.
Eigen::Matrix2f PlaneWarp(const Camera& camera, const Observation& ref,
                          const Rigid3d& cur_from_ref);

}  // namespace rgbd_pose
