#pragma once

#include "costs/cost_list.h"
#include "costs/direct/inverse_depth.h"
#include "costs/direct/photometric.h"
#include "costs/direct/projective_plane.h"

namespace rgbd_pose {

// All direct residual types. A new direct cost needs one header and one entry
// here, as in cost_list.h.
using DirectResidualTypes =
    TypeList<Photometric, InverseDepth, ProjectivePlane>;

}  // namespace rgbd_pose
