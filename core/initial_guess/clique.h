#pragma once

#include <optional>
#include <string>

#include "core/estimation/correspondences.h"
#include "core/initial_guess/consensus.h"

namespace rgbd_pose {

struct CliqueOptions {
  // Two matches are consistent if the distance between their points changes
  // from frame to frame by at most this many of its standard deviations.
  double max_distance_sigmas = 3.0;

  // Of more matches, this many are used, evenly spread over the list: time and
  // memory grow with the square.
  int max_matches = 500;

  ConsensusOptions consensus;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The motion of a greatest set of matches that are all consistent with each
// other, found greedily: the match with the most consistent partners first,
// then the next that is consistent with all taken so far (Howard, "Real-time
// stereo visual odometry for autonomous ground vehicles", IROS 2008). Ties go
// to the earlier match; nothing is random. The motion is that of the set in
// closed form, fitted again to the matches that agree with it. Matches without
// a depth on both sides do not count. Nothing if too few agree or those that do
// leave the motion undetermined. Throws InputError if the options are wrong.
std::optional<Consensus> FindByClique(const Correspondences& matches,
                                      const CliqueOptions& options = {});

}  // namespace rgbd_pose
