#pragma once

#include "core/estimation/motion_cost.h"
#include "costs/parts/cost_input.h"
#include "costs/parts/image_error.h"

namespace rgbd_pose {

// The previous point in the current image and its inverse depth there, in the
// manner of ORB-SLAM2 (Mur-Artal & Tardos 2017), which takes the depth for the
// column of a virtual right camera, f b / z:
//
//   r = L^T (m_cur - project(R (X_prev - C))),  m = (u, v, 1 / z)
//
// L L^T is the inverse of the noise of m_cur plus that of the projected point,
// frozen at the motion that was bound. Needs both depths. Points behind the
// camera: projection.h.
struct ReprojectionDepth {
  static constexpr char kName[] = "reprojection_depth";
  static constexpr int kRows = 3;
  static constexpr int kIndependentRows = 3;
  static constexpr Association kAssociation = Association::kWhenMoved;
  static constexpr bool kIsWhitened = true;
  static constexpr int kColumns = ImageError<3, Forward, double>::kColumns;

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Observation& prev = input.matches[i].prev;
    const Observation& cur = input.matches[i].cur;
    if (prev.depth <= 0.0 || cur.depth <= 0.0) return false;
    return PackImageError<3>(input.matches, input.cur_from_prev, prev, cur, 1.0,
                             columns);
  }

  template <typename M, typename D, typename T>
  static void Residual(const MotionPose<M>& motion, const D* columns, T* r) {
    ImageError<3, Forward, D>(columns).Residual(motion, r);
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    ImageError<3, Forward, D>(columns).Jacobian(motion, r, J);
  }
};

}  // namespace rgbd_pose
