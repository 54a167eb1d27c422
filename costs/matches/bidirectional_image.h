#pragma once

#include <algorithm>

#include "core/estimation/motion_cost.h"
#include "costs/parts/image_error.h"

namespace rgbd_pose {

// Reprojection in both directions (Howard 2008; Huang 2013): the previous point
// in the current image and the current point in the previous image, each with
// u, v and inverse depth:
//
//   rows 0-2  L_c^T (m_cur  - project(R (X_prev - C)))
//   rows 3-5  L_p^T (m_prev - project(R^T X_cur + C))
//
// L L^T is the inverse covariance of the measurement plus the projected point,
// frozen at the bound motion. Both directions contain the same measurements
// with the noise of both frames, so each covariance is doubled.
//
// If only one frame has depth, only its points can be projected, and only u and
// v can be compared: two rows, not doubled; the other four are zero.
struct BidirectionalImage {
  static constexpr char kName[] = "bidirectional_image";
  static constexpr int kRows = 6;
  static constexpr int kDegreesOfFreedom = 3;
  static constexpr AssociationPolicy kAssociation =
      AssociationPolicy::kWhenMoved;
  static constexpr bool kIsWhitened = true;
  static constexpr int kForwardColumns = ImageError<3, Forward>::kColumns;
  static constexpr int kColumns = 2 * kForwardColumns;

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Correspondences& matches = input.matches;
    const Observation& prev = matches[i].prev;
    const Observation& cur = matches[i].cur;
    const bool forward = prev.depth > 0.0;
    const bool backward = cur.depth > 0.0;
    const double repeats = forward && backward ? 2.0 : 1.0;
    std::fill_n(columns, kColumns, 0.0);
    if (forward && !PackImageError<3>(matches, input.cur_from_prev, prev, cur,
                                      repeats, columns)) {
      return false;
    }
    if (backward &&
        !PackImageError<3>(matches, input.cur_from_prev.Inverse(), cur, prev,
                           repeats, columns + kForwardColumns)) {
      return false;
    }
    return forward || backward;
  }

  // 2 if an inverse depth is missing: u and v of one direction.
  static int Degrees(const double* columns) {
    return columns[kForwardColumns - 1] > 0.0 ? 3 : 2;
  }

  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    ImageError<3, Forward>::Residual(motion, columns, r);
    ImageError<3, Backward>::Residual(motion, columns + kForwardColumns, r + 3);
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    ImageError<3, Forward>::Jacobian(motion, columns, r, J);
    ImageError<3, Backward>::Jacobian(motion, columns + kForwardColumns, r + 3,
                                      J + 3);
  }
};

}  // namespace rgbd_pose
