#pragma once

#include "costs/assembly/packed_sum.h"
#include "costs/direct/direct_input.h"

namespace rgbd_pose {

// How gray levels change from the previous frame to the current one, whose
// exposure is its own: sets input->gain and bias by robust regression over the
// textured points (direct_points.h) that are seen at input's motion. Weak
// priors (gain 1 +- 0.3, bias 0 +- 40 gray levels) decide where there is no
// texture to tell.
void EstimateBrightness(const PackedColumns& points, DirectInput* input);

}  // namespace rgbd_pose
