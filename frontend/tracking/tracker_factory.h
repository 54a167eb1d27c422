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

// What trackers are made of; each takes what it needs.
struct TrackerParts {
  TrackerOptions options;          // when to be content
  FrontendOptions images;          // the camera, and which depths to use
  std::string frontend = "patch";  // where features come from
  Estimator estimator;             // makes motions of what is matched

  // Of trackers that look at the images. A tracker by features goes without,
  // and then starts from the guess.
  std::optional<DirectEstimators> direct_estimators = std::nullopt;
  // When to be content with them.
  DirectTrackerOptions direct_options = {};
};

// The names of all trackers.
std::vector<std::string> TrackerNames();

// The tracker of that name. Throws InputError listing the names there are, or
// saying what is wrong with the options.
std::unique_ptr<Tracker> MakeTracker(std::string_view name, TrackerParts parts);

}  // namespace rgbd_pose
