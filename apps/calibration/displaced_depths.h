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

// Whether a change of theta is so large that depth has to be looked up
// elsewhere.
bool IsDisplaced(const CalibrationVector& theta);

// How far a change of theta displaces depth in the image, px: the median of
// landmarks.
double DisplacementPx(const CalibrationViews& views,
                      const CalibrationVector& change);

// Undoes what theta says of the displacement of depth (registration, delay) in
// the images of the keyframes and looks all depths up again: so large ones come
// right that are not linear. `camera`: the lens as it is known by now.
void LookUpDepthsAnew(const KeyframeMap& map, const Camera& camera,
                      const OdometrySettings& settings,
                      const CalibrationVector& theta, int threads,
                      CalibrationData* data);

// What an observation at `pixel` (as seen, distorted) says of depth. Nothing
// where the surface is no plane.
MeasuredInverseDepth MeasuredAt(const Frame& frame, const Camera& camera,
                                const Observation& o,
                                const Eigen::Vector2d& pixel,
                                const DepthNoiseModel& noise);

}  // namespace rgbd_pose
