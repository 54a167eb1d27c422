#pragma once

#include <gtest/gtest.h>

#include <memory>
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

// A reference made of a frame.
inline std::unique_ptr<Reference> ReferenceOf(Tracker* tracker,
                                              const PreparedFrame& frame) {
  std::string why_not;
  auto reference = tracker->MakeReference(frame, nullptr, nullptr, &why_not);
  EXPECT_NE(reference, nullptr) << why_not;
  return reference;
}

}  // namespace rgbd_pose
