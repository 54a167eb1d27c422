#pragma once

#include <array>
#include <string>
#include <vector>

#include "apps/pipeline/settings.h"
#include "core/evaluation/trajectory.h"
#include "costs/calibration/calibration_views.h"
#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// Which views a camera is calibrated from.
struct CalibrationDataOptions {
  // Views of landmarks, about: the time that a solution takes grows with it.
  int max_views = 40000;

  // At most so many keyframes, evenly chosen: the work grows with the third
  // power of their number.
  int max_keyframes = 300;

  // Every n-th pair is kept to judge the result by.
  int hold_out = 5;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The keyframes that the views are of.
struct CalibrationData {
  CalibrationViews views;
  std::vector<double> timestamps;         // of keyframes, s
  std::vector<std::array<int, 2>> pairs;  // of keyframes
  std::vector<int> in_map;                // their places in the map
};

// Finds the features of each keyframe of the map's largest segment again in
// those that it is paired with. `path`: a smooth path of the camera (world from
// camera, any world), for its velocities.
CalibrationData CollectCalibrationData(const KeyframeMap& map,
                                       const Trajectory& path,
                                       const OdometrySettings& settings,
                                       const CalibrationDataOptions& options,
                                       int threads);

}  // namespace rgbd_pose
