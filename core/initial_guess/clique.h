#pragma once

#include <optional>

#include "core/estimation/correspondences.h"
#include "core/initial_guess/consensus.h"

namespace rgbd_pose {

// The motion of a greatest set of matches that are all consistent with each
// other, found greedily: the match with the most consistent partners first,
// then the next that is consistent with all taken so far (Howard, "Real-time
// stereo visual odometry for autonomous ground vehicles", IROS 2008). Ties go
// to the earlier match; nothing is random. The motion is that of the set in
// closed form, fitted again to the matches that agree with it. Matches without
// a depth on both sides do not count. Nothing if too few agree or those that do
// leave the motion undetermined.
std::optional<Consensus> FindByClique(const Correspondences& matches);

}  // namespace rgbd_pose
