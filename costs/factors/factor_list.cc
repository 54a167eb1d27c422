#include "costs/factors/factor_list.h"

#include "core/factors/common_direction.h"
#include "core/factors/distance.h"
#include "core/factors/relative_pose.h"
#include "core/util/type_list.h"
#include "costs/calibration/landmark_factors.h"
#include "costs/calibration/scaled_distance.h"
#include "costs/factors/absolute_pose.h"
#include "costs/factors/absolute_position.h"
#include "costs/factors/constant_velocity.h"
#include "costs/factors/gravity.h"
#include "costs/factors/gyroscope.h"
#include "costs/factors/inertial.h"
#include "costs/factors/landmark.h"
#include "costs/factors/map_plane.h"
#include "costs/factors/relative_rotation.h"

namespace rgbd_pose {
namespace {

using FactorTypes =
    TypeList<AbsolutePoseFactor, AbsolutePositionFactor, RelativePoseFactor,
             RelativeRotationFactor, GravityFactor, CommonDirectionFactor,
             ConstantVelocityFactor, DistanceFactor, MapPlaneFactor,
             LandmarkFactor, LandmarkPixelFactor, LandmarkDepthFactor,
             AnchorDepthFactor, ScaledDistanceFactor, GyroscopeFactor,
             InertialFactor>;

template <typename... Factors>
std::vector<ListedFactor> ListOf(TypeList<Factors...> /*types*/) {
  return {{Factors::kName, [](FactorSampler* random) {
             return MakeCheckable(Factors::Sample(random));
           }}...};
}

}  // namespace

const std::vector<ListedFactor>& ListedFactors() {
  static const std::vector<ListedFactor> list = ListOf(FactorTypes());
  return list;
}

}  // namespace rgbd_pose
