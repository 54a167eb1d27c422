#pragma once

#include <string>

#include "apps/calibration/calibration.h"

namespace rgbd_pose {

// Adds the distances that are known (KnownDistance): of --known_length, of the
// ground truth or of a motion guess, the first there is. `path`: of all frames,
// as they were tracked. Returns in words where they are from; empty: nothing is
// known. Throws InputError for a known length that makes no sense.
std::string AddKnownDistances(const KeyframeMap& map, const Trajectory& path,
                              const std::string& known_length,
                              const CalibrationScale& scale,
                              CalibrationData* data);

}  // namespace rgbd_pose
