#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/initial_guess/point_match.h"

namespace rgbd_pose {

// A motion and the matches that agree with it.
struct Consensus {
  Rigid3d cur_from_prev;
  std::vector<int> inliers;  // within the Correspondences, increasing
};

struct ConsensusOptions {
  // So many matches have to agree, in number and as a share of those with a
  // depth on both sides, before it counts as more than chance.
  int min_inliers = 6;
  double min_inlier_share = 0.1;

  // How often the motion is fitted anew to those that agree with it.
  int refits = 2;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The greatest squared whitened distance of a match that agrees with a motion:
// that of 99 % of the right ones.
double MaxSquaredDistance();

// The motion that fits the matches of these places in closed form.
std::optional<Rigid3d> FitTo(const std::vector<PointMatch>& matches,
                             const std::vector<int>& chosen);

// The places of the matches that agree with a motion.
void FindInliers(const std::vector<PointMatch>& matches,
                 const Rigid3d& cur_from_prev, std::vector<int>* inliers);

// Fits the motion anew to those that agree with it, some times over. Nothing
// if too few agree or those that do leave the motion open.
std::optional<Consensus> FindConsensus(const std::vector<PointMatch>& matches,
                                       const Rigid3d& cur_from_prev,
                                       const ConsensusOptions& options);

}  // namespace rgbd_pose
