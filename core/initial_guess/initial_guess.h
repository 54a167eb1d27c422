#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A method that guesses the motion from the matches alone.
struct InitialGuess {
  std::string_view name;  // as given to programs
  // Returns cur_from_prev, or nothing if the matches do not determine it; the
  // caller then uses its own guess, such as the last motion.
  std::optional<Rigid3d> (*find)(const Correspondences& matches);
};

// All initial guesses:
//   identity  no motion, whatever the matches are
//   ransac    the motion with most agreement among random samples of three
//   clique    the motion of matches that preserve all their distances
//
// The last two are FindByRansac and FindByClique (consensus.h).
const std::vector<InitialGuess>& InitialGuesses();

// The initial guess with this name, or null.
const InitialGuess* FindInitialGuess(std::string_view name);

}  // namespace rgbd_pose
