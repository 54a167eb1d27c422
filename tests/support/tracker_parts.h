#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "costs/cost_factory.h"
#include "costs/direct_cost_factory.h"
#include "frontend/tracking/tracker_factory.h"

namespace rgbd_pose {

// The parts of any tracker, with the programs' defaults.
inline TrackerParts PartsFor(const Camera& camera,
                             const TrackerOptions& options = {}) {
  TrackerParts parts{options, {}, "patch", Estimator({}, MakeRobustCosts())};
  parts.images.camera = camera;
  parts.direct_estimators = DirectEstimators{
      Estimator(DirectEstimatorOptions(), MakeDirectCosts()),
      Estimator(
          DirectEstimatorOptions(),
          JoinCosts(MakeRobustCosts(),
                    MakeDirectCosts(kDefaultDirectCost, kDefaultDirectLoss))),
      MakeCoarseEstimator()};
  return parts;
}

}  // namespace rgbd_pose
