#pragma once

#include <array>
#include <string>
#include <vector>

#include "apps/pipeline/settings.h"
#include "core/evaluation/trajectory.h"
#include "costs/calibration/calibration_views.h"
#include "frontend/map/keyframe_map.h"
#include "frontend/tracking/motion_guess.h"

namespace rgbd_pose {

// The keyframes of a map that a camera is calibrated from, which of them see
// the same, and what.
struct CalibrationData {
  std::vector<int> in_map;                // their places in the map
  std::vector<double> timestamps;         // s
  std::vector<std::array<int, 2>> pairs;  // of these keyframes, near ones first
  std::vector<bool> is_held_out;          // of each pair
  CalibrationViews views;
};

// The landmarks of one keyframe, with its views still its own.
struct LandmarksOfKeyframe {
  std::vector<Landmark> landmarks;
  std::vector<std::vector<LandmarkView>> views;  // of each landmark
};

// Finds up to `max_features` features of each keyframe again in those that it
// is paired with.
std::vector<LandmarksOfKeyframe> FindLandmarks(const KeyframeMap& map,
                                               const CalibrationData& chosen,
                                               const OdometrySettings& settings,
                                               int max_features, int threads);

// Takes up to 300 keyframes of the map's largest segment, evenly chosen, in the
// order of their times, and finds the features of each again in those that it
// is paired with. Every fifth pair is held out, to judge the result by, but
// none that two keyframes hang together by. `path`: a smooth path of the camera
// (world from camera, any world), for its velocities. `max_views`: of
// landmarks, about.
CalibrationData CollectCalibrationData(const KeyframeMap& map,
                                       const Trajectory& path,
                                       const OdometrySettings& settings,
                                       int max_views, int threads);

// What else is known of where the camera was; null: nothing.
struct CalibrationScale {
  const Trajectory* ground_truth = nullptr;   // the true path
  const MotionGuess* motion_guess = nullptr;  // wheels, say
};

// Adds the distances that are known (KnownDistance): of --known_length, of the
// ground truth or of a motion guess, the first there is. `path`: of all frames,
// as they were tracked. Returns in words where they are from; empty: nothing is
// known. Throws InputError for a known length that makes no sense.
std::string AddKnownDistances(const Trajectory& path,
                              const std::string& known_length,
                              const CalibrationScale& scale,
                              CalibrationData* data);

}  // namespace rgbd_pose
