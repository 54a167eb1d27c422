#pragma once

#include "core/factors/common_direction.h"
#include "core/factors/relative_pose.h"
#include "core/util/type_list.h"
#include "costs/factors/absolute_pose.h"
#include "costs/factors/absolute_position.h"
#include "costs/factors/constant_velocity.h"
#include "costs/factors/distance.h"
#include "costs/factors/gravity.h"
#include "costs/factors/gyroscope.h"
#include "costs/factors/inertial.h"
#include "costs/factors/landmark.h"
#include "costs/factors/map_plane.h"
#include "costs/factors/relative_rotation.h"

namespace rgbd_pose {

// All factors that depend on no cost. A new one needs its header, an entry here
// and a row in docs/factors.md; its Jacobian test and its lines in
// rgbd_jacobians follow from this list.
using FactorTypes =
    TypeList<AbsolutePoseFactor, AbsolutePositionFactor, RelativePoseFactor,
             RelativeRotationFactor, GravityFactor, CommonDirectionFactor,
             ConstantVelocityFactor, DistanceFactor, MapPlaneFactor,
             LandmarkFactor, GyroscopeFactor, InertialFactor>;

}  // namespace rgbd_pose
