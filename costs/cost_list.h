#pragma once

#include "costs/bidirectional_image.h"
#include "costs/bidirectional_point.h"
#include "costs/epipolar.h"
#include "costs/mahalanobis_point.h"
#include "costs/motion_prior.h"
#include "costs/point_to_plane.h"
#include "costs/point_to_point.h"
#include "costs/reprojection.h"
#include "costs/reprojection_depth.h"

namespace rgbd_pose {

template <typename... Types>
struct TypeList {};

// All residual types. One header and one entry here make a cost: its Jacobian
// test, its benchmark, its name for programs and its place in the assemblies
// follow from this list.
using ResidualTypes =
    TypeList<BidirectionalPoint, BidirectionalImage, PointToPoint,
             MahalanobisPoint, PointToPlane, Reprojection, ReprojectionDepth,
             Epipolar, MotionPriorCost>;

}  // namespace rgbd_pose
