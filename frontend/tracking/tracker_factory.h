#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/estimation/estimator.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/direct_tracker.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// The parts of trackers; each tracker takes the ones it needs.
struct TrackerParts {
  TrackerOptions options;          // when to accept a motion
  FrontendOptions images;          // the camera, and which depths to use
  std::string frontend = "patch";  // provides the features
  Estimator estimator;             // estimates motions from matches

  // Estimators of trackers that use the images. Optional for a tracker by
  // features, which then starts from the guess.
  std::optional<DirectEstimators> direct_estimators = std::nullopt;
};

// Returns the names of all trackers.
std::vector<std::string> TrackerNames();

// Returns the tracker with this name. Throws InputError with the list of names
// if there is no such tracker, or with the reason if options are invalid.
std::unique_ptr<Tracker> MakeTracker(std::string_view name, TrackerParts parts);

}  // namespace rgbd_pose
