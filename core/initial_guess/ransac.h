#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/estimation/correspondences.h"
#include "core/initial_guess/consensus.h"

namespace rgbd_pose {

struct RansacOptions {
  // The most samples of three matches to draw.
  int max_samples = 500;

  // Sampling ends early when, at the share of inliers seen so far, a sample of
  // right matches only has been drawn with this probability.
  double confidence = 0.999;

  // A sample is rejected if a distance between two of its points changes from
  // frame to frame by more than this many standard deviations.
  double max_distance_sigmas = 3.0;

  // Of more matches, this many are used, evenly spread over the list.
  int max_matches = 1000;

  uint64_t seed = 1;

  ConsensusOptions consensus;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The motion that most matches agree with, by random samples of three matches
// and closed form (Fischler & Bolles 1981), each new best one fitted anew to
// those that agree with it (Chum, Matas & Kittler 2003). Distances are whitened
// by the noise of both frames; matches without a depth on both sides do not
// count. The same input gives the same bytes. Nothing if too few matches agree
// with any motion or those that do leave it undetermined. Throws InputError if
// the options are wrong.
std::optional<Consensus> FindByRansac(const Correspondences& matches,
                                      const RansacOptions& options = {});

}  // namespace rgbd_pose
