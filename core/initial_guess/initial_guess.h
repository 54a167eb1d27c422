#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A way to guess the motion from the matches alone, without a place to start.
struct InitialGuess {
  std::string_view name;  // as programs take it
  // cur_from_prev, or nothing if the matches do not determine it; the caller
  // then uses a guess of its own, such as the last motion.
  std::optional<Rigid3d> (*find)(const Correspondences& matches);
};

// All initial guesses:
//   identity  no motion, whatever the matches say
//   ransac    what random samples of three find most agreement with
//   clique    that of the matches that preserve all their distances
//
// The last two are FindByRansac and FindByClique (consensus.h).
const std::vector<InitialGuess>& InitialGuesses();

// The initial guess of that name, or null.
const InitialGuess* FindInitialGuess(std::string_view name);

}  // namespace rgbd_pose
