#pragma once

#include <optional>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/initial_guess/point_match.h"

namespace rgbd_pose {

// A motion and the matches that agree with it.
struct Consensus {
  Rigid3d cur_from_prev;
  std::vector<int> inliers;  // indices within the Correspondences, increasing
};

struct ConsensusOptions {
  // A motion counts as found if at least this many matches agree with it, and
  // at least this share of those with a depth on both sides.
  int min_inliers = 6;
  double min_inlier_share = 0.1;
};

// The largest squared whitened distance of an inlier: 99 % are below it.
double MaxSquaredDistance();

// The closed-form motion of the matches at these indices.
std::optional<Rigid3d> FitRigidTransform(const std::vector<PointMatch>& matches,
                                         const std::vector<int>& chosen);

// The indices of the matches that agree with a motion.
void FindInliers(const std::vector<PointMatch>& matches,
                 const Rigid3d& cur_from_prev, std::vector<int>* inliers);

// Refits the motion several times to the matches that agree with it. Empty if
// too few agree or if they leave the motion undetermined.
std::optional<Consensus> FindConsensus(const std::vector<PointMatch>& matches,
                                       const Rigid3d& cur_from_prev,
                                       const ConsensusOptions& options);

// The motion that most matches agree with, by random samples of three matches
// and closed form (Fischler & Bolles 1981). Each new best motion is refitted to
// its inliers (Chum, Matas & Kittler 2003). Distances are whitened by the noise
// of both frames; matches without a depth on both sides are ignored. The result
// is reproducible bit by bit. Empty if too few matches agree or leave the
// motion undetermined.
std::optional<Consensus> FindByRansac(const Correspondences& matches,
                                      const ConsensusOptions& options = {});

// The motion of a large set of matches that are all consistent with each other,
// found greedily: the match with the most consistent partners first, then the
// next that is consistent with all taken so far (Howard, "Real-time stereo
// visual odometry for autonomous ground vehicles", IROS 2008). Ties go to the
// earlier match; nothing is random. The motion is fitted to the set in closed
// form, then refitted to the matches that agree with it. Ignores matches
// without a depth on both sides. Empty if too few agree or leave the motion
// undetermined.
std::optional<Consensus> FindByClique(const Correspondences& matches);

}  // namespace rgbd_pose
