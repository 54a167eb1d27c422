#pragma once

#include <Eigen/Core>

#include "apps/calibration/calibration_data.h"
#include "apps/pipeline/settings.h"
#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_views.h"
#include "costs/calibration/landmark_residuals.h"
#include "frontend/frame/frame.h"
#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// Whether a change of theta moves depth so far that it must be looked up again.
bool IsDisplaced(const CalibrationVector& theta);

// How far a change of theta displaces depth, px (median over landmarks).
double DisplacementPx(const CalibrationViews& views,
                      const CalibrationVector& change);

// Undoes the displacement of depth (registration, delay) that theta describes
// in the images of the keyframes and looks up all depths again. This corrects
// large, non-linear displacements. `camera` is the current estimate of the
// lens.
void LookUpDepthsAgain(const KeyframeMap& map, const Camera& camera,
                       const OdometrySettings& settings,
                       const CalibrationVector& theta, int threads,
                       CalibrationData* data);

// Returns the depth measurement for an observation at `pixel` (distorted). It
// is invalid (inverse_sigma is 0) where the surface is not a plane.
MeasuredInverseDepth MeasuredAt(const Frame& frame, const Camera& camera,
                                const Observation& o,
                                const Eigen::Vector2d& pixel,
                                const DepthNoiseModel& noise);

}  // namespace rgbd_pose
