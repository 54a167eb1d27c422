#pragma once

#include "costs/matches/bidirectional_image.h"
#include "costs/matches/bidirectional_point.h"
#include "costs/matches/epipolar.h"
#include "costs/matches/mahalanobis_point.h"
#include "costs/matches/motion_prior.h"
#include "costs/matches/point_to_plane.h"
#include "costs/matches/point_to_point.h"
#include "costs/matches/reprojection.h"
#include "costs/parts/cost_input.h"

namespace rgbd_pose {

// All residual types. A new cost needs one header and one entry here; its
// Jacobian test, its benchmark, its name in programs and its place in the
// assemblies follow from this list.
using ResidualTypes =
    TypeList<BidirectionalPoint, BidirectionalImage, PointToPoint,
             MahalanobisPoint, PointToPlane, Reprojection, ReprojectionDepth,
             Epipolar, MotionPriorCost>;

}  // namespace rgbd_pose
