#pragma once

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Whether two motions differ by no more than a rotation (rad) and a translation
// (m).
inline bool IsWithin(const Rigid3d& a, const Rigid3d& b, double rotation,
                     double translation) {
  const Rigid3d moved = a.Inverse() * b;
  return moved.Angle() <= rotation && moved.translation.norm() <= translation;
}

}  // namespace rgbd_pose
