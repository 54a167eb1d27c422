#pragma once

#include "core/geometry/camera.h"
#include "frontend/calibration/calibration.h"

namespace rgbd_pose {

// Whether the recording should be mapped again with the camera that a pass
// found: that camera is better, but depth or rows were displaced so far that it
// is only a first step.
bool IsAnotherPassDue(const CalibrationResult& result);

// Takes the result of a further pass, which mapped the recording with the
// camera found so far, into the result of all passes; `first` is the camera of
// the first pass. If the pass found no better camera, the camera found so far
// stays. In either case the halves of the further pass judge it, because
// displaced depth makes those of earlier passes differ.
void TakeUp(const RgbdCamera& first, const CalibrationSettings& settings,
            const CalibrationResult& further, CalibrationResult* all);

}  // namespace rgbd_pose
