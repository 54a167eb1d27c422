#pragma once

#include "core/estimation/motion_cost.h"
#include "costs/parts/image_error.h"

namespace rgbd_pose {

// Common part of the reprojections: u, v and, if N = 3, inverse depth.
template <int N>
struct ReprojectionOf : ImageError<N, Forward> {
  static constexpr int kRows = N;
  static constexpr int kDegreesOfFreedom = N;
  static constexpr AssociationPolicy kAssociation =
      AssociationPolicy::kWhenMoved;
  static constexpr bool kIsWhitened = true;

  static bool Pack(const CostInput& input, size_t i, double* columns) {
    const Observation& prev = input.matches[i].prev;
    const Observation& cur = input.matches[i].cur;
    if (prev.depth <= 0.0 || (N == 3 && cur.depth <= 0.0)) return false;
    return PackImageError<N>(input.matches, input.cur_from_prev, prev, cur, 1.0,
                             columns);
  }
};

// The previous point in the current image, as in the refinement of a
// perspective-n-point pose (Lepetit, Moreno-Noguer & Fua 2009):
//
//   r = L^T (m_cur - project(R (X_prev - C))),  m = (u, v)
//
// L L^T is the inverse covariance of m_cur plus the projected point, frozen at
// the bound motion. Needs only the depth of the previous frame.
struct Reprojection : ReprojectionOf<2> {
  static constexpr char kName[] = "reprojection";
};

// The previous point in the current image and its inverse depth there, as in
// ORB-SLAM2 (Mur-Artal & Tardos 2017), which expresses depth as the column in a
// virtual right camera, f b / z:
//
//   r = L^T (m_cur - project(R (X_prev - C))),  m = (u, v, 1 / z)
//
// with L as above. Needs both depths.
struct ReprojectionDepth : ReprojectionOf<3> {
  static constexpr char kName[] = "reprojection_depth";
};

}  // namespace rgbd_pose
