#pragma once

#include <memory>
#include <string>

#include "core/estimation/estimator.h"
#include "core/geometry/camera.h"
#include "costs/cost_factory.h"
#include "costs/direct_cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/odometry.h"
#include "frontend/tracking/tracker_factory.h"

namespace rgbd_pose {

// What an estimator is made of. Defaults are those of the parts.
struct EstimatorSettings {
  std::string cost = kDefaultCost;  // of a match; several add up: "a+b"
  std::string loss = kDefaultLoss;  // one for all costs or one each: "a,b"
  EstimatorOptions options;         // how it is minimised
};

// What an estimator of pixels is made of.
struct DirectSettings {
  std::string cost = kDefaultDirectCost;  // of a pixel; several add up: "a+b"
  std::string loss = kDefaultDirectLoss;  // one for all costs or one each
  DirectOptions points;                   // which pixels
  EstimatorOptions options = DirectEstimatorOptions();  // how it is minimised
};

// What an odometry is made of: the one place for programs, Python and
// benchmarks. setting_table.h gives each value that a user may want a name.
struct OdometrySettings {
  EstimatorSettings estimator;           // what explains the matches
  std::string frontend = "patch";        // where matches come from
  FrontendOptions features;              // without the camera
  std::string tracker = "hybrid";        // how a frame is followed
  TrackerOptions tracking;               // what of that is believed
  DirectSettings direct;                 // what explains the pixels
  DirectTrackerOptions direct_tracking;  // what of that is believed
  OdometryOptions odometry;              // when to go on, and what if lost
};

// An estimator, tracker or odometry with these settings. Throws InputError for
// unknown names and values that make no sense.
Estimator MakeEstimator(const EstimatorSettings& settings);
DirectEstimators MakeDirectEstimators(const EstimatorSettings& matches,
                                      const DirectSettings& pixels);
std::unique_ptr<Tracker> MakeTracker(const OdometrySettings& settings,
                                     const Camera& camera);
Odometry MakeOdometry(const OdometrySettings& settings, const Camera& camera);

}  // namespace rgbd_pose
