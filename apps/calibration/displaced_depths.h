#pragma once

#include "apps/calibration/calibration_data.h"
#include "apps/pipeline/settings.h"
#include "core/geometry/camera.h"
#include "costs/calibration/calibration_parameters.h"
#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// Undoes what theta says of the displacement of depth (registration, delay) in
// the images of the keyframes and looks all depths up anew: so large ones come
// right that are not linear. `camera`: the lens as it is known by now.
void LookUpDepthsAnew(const KeyframeMap& map, const Camera& camera,
                      const OdometrySettings& settings,
                      const CalibrationVector& theta, int threads,
                      CalibrationData* data);

}  // namespace rgbd_pose
