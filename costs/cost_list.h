#pragma once

#include <memory>
#include <string_view>

#include "core/estimation/motion_cost.h"
#include "core/util/type_list.h"
#include "costs/direct/inverse_depth.h"
#include "costs/direct/photometric.h"
#include "costs/direct/projective_plane.h"
#include "costs/matches/bidirectional_image.h"
#include "costs/matches/bidirectional_point.h"
#include "costs/matches/epipolar.h"
#include "costs/matches/mahalanobis_point.h"
#include "costs/matches/motion_prior.h"
#include "costs/matches/point_to_plane.h"
#include "costs/matches/point_to_point.h"
#include "costs/matches/reprojection.h"

namespace rgbd_pose {

// All residual types over matches. A new cost needs one header and one entry
// here; its Jacobian test, its benchmark, its name in programs and its place in
// the assemblies follow from this list.
using ResidualTypes =
    TypeList<BidirectionalPoint, BidirectionalImage, PointToPoint,
             MahalanobisPoint, PointToPlane, Reprojection, ReprojectionDepth,
             Epipolar, MotionPriorCost>;

// All direct residual types, likewise.
using DirectResidualTypes =
    TypeList<Photometric, InverseDepth, ProjectivePlane>;

// A Cost<Type>(options...) of the type with that name, or null.
template <template <typename> typename Cost, typename... Types,
          typename... Options>
std::unique_ptr<MotionCost> MakeNamed(TypeList<Types...>, std::string_view name,
                                      const Options&... options) {
  std::unique_ptr<MotionCost> cost;
  static_cast<void>(((name == Types::kName &&
                      (cost = std::make_unique<Cost<Types>>(options...))) ||
                     ...));
  return cost;
}

}  // namespace rgbd_pose
