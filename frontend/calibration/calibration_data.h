#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "costs/calibration/calibration_views.h"
#include "frontend/features/frontend.h"
#include "frontend/slam/keyframe_map.h"

namespace rgbd_pose {

// The keyframes of a map that a camera is calibrated from, the pairs of
// keyframes that see the same surfaces, and their common landmarks.
struct CalibrationData {
  std::vector<int> in_map;                // indices in the map
  std::vector<double> timestamps;         // s
  std::vector<std::array<int, 2>> pairs;  // of these keyframes, near ones first
  CalibrationViews views;
};

// Takes up to 300 evenly chosen keyframes of the map's largest segment, in
// order of time, and matches the features of each keyframe in the keyframes
// that it is paired with. Every fifth pair is held out for judging the result,
// except pairs that are needed to connect the keyframes. `path` is a smooth
// path of the camera (world from camera, any world), from which velocities are
// computed. `max_views` is the approximate number of landmark views.
CalibrationData CollectCalibrationData(const KeyframeMap& map,
                                       const Trajectory& path,
                                       const FrontendOptions& features,
                                       int max_views, int threads);

// Other sources of the camera's position. A null pointer means that the source
// is not available.
struct CalibrationScale {
  const Trajectory* ground_truth = nullptr;  // the true path
  const Trajectory* motion_guess = nullptr;  // for example from wheels
};

// Adds known distances (KnownDistance) from the first available source:
// `known_length`, the ground truth, or the motion guess. `path` has all frames
// as they were tracked. Returns the name of the source in words, or an empty
// string if there is none. Throws InputError for an invalid known length.
std::string AddKnownDistances(const Trajectory& path,
                              const std::string& known_length,
                              const CalibrationScale& scale,
                              CalibrationData* data);

// Whether a change of theta moves depth so far that it must be looked up again.
bool IsDisplaced(const CalibrationVector& theta);

// How far a change of theta displaces depth, px (median over landmarks).
double DisplacementPx(const CalibrationViews& views,
                      const CalibrationVector& change);

// Undoes the displacement of depth (registration, delay) that theta describes
// in the images of the keyframes and looks up all depths again, as a large
// displacement is not linear. `camera` has the current estimate of the lens.
void LookUpDepthsAgain(const KeyframeMap& map, const Camera& camera,
                       const DepthLookupOptions& options,
                       const CalibrationVector& theta, int threads,
                       CalibrationData* data);

// Returns the depth measurement for an observation at `pixel` (distorted). It
// is invalid (inverse_sigma is 0) where the surface is not a plane.
MeasuredInverseDepth MeasuredAt(const Frame& frame, const Camera& camera,
                                const Observation& o,
                                const Eigen::Vector2d& pixel,
                                const DepthNoiseModel& noise);

}  // namespace rgbd_pose
