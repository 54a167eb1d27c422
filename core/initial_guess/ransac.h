#pragma once

#include <optional>

#include "core/estimation/correspondences.h"
#include "core/initial_guess/consensus.h"

namespace rgbd_pose {

// The motion that most matches agree with, by random samples of three matches
// and closed form (Fischler & Bolles 1981), each new best one fitted again to
// those that agree with it (Chum, Matas & Kittler 2003). Distances are whitened
// by the noise of both frames; matches without a depth on both sides do not
// count. The same input gives the same bytes. Nothing if too few matches agree
// with any motion or those that do leave it undetermined.
std::optional<Consensus> FindByRansac(const Correspondences& matches,
                                      const ConsensusOptions& options = {});

}  // namespace rgbd_pose
