#pragma once

#include <cstddef>

#include "core/estimation/correspondences.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// One of the cameras on a body.
struct CameraMounting {
  int camera = 0;         // the index of its pair among those of an estimate
  Rigid3d body_from_cam;  // its place on the body, which is constant
};

// The matches of one camera among those of all.
struct CameraMatches {
  const Correspondences* matches;  // never null
  size_t first = 0;                // the index of its first match among all
  Rigid3d body_from_cam;
};

// The motion of a camera, cur_from_prev, when the body moves.
Rigid3d CameraMotion(const Rigid3d& body_from_cam, const Rigid3d& body_motion);

// d[omega C] of the camera / d[omega C] of the body, as in MotionEstimate. With
// M, p the mounting, R, C the body's motion:
//
//   omega_cam = M^T omega
//   C_cam     = M^T (C - p + R^T p)
MotionMatrix CameraMotionJacobian(const Rigid3d& body_from_cam,
                                  const Rigid3d& body_motion);

}  // namespace rgbd_pose
