#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/rigid3.h"
#include "core/initial_guess/consensus.h"

namespace rgbd_pose {

// A method that guesses the motion from the matches alone.
struct InitialGuess {
  std::string_view name;  // as given to programs
  // Returns cur_from_prev, or nothing if the matches do not determine it.
  std::optional<Rigid3d> (*find)(const Correspondences& matches);
};

// All initial guesses:
//   identity  no motion, whatever the matches are
//   ransac    FindByRansac: most agreement among random samples of three
//   clique    FindByClique: matches that preserve all their distances
inline const std::vector<InitialGuess>& InitialGuesses() {
  static constexpr auto kMotionOf = [](const std::optional<Consensus>& found) {
    return found ? std::optional(found->cur_from_prev) : std::nullopt;
  };
  static const auto& guesses = *new std::vector<InitialGuess>{
      {"identity", [](const auto&) { return std::optional(Rigid3d()); }},
      {"ransac", [](const auto& m) { return kMotionOf(FindByRansac(m)); }},
      {"clique", [](const auto& m) { return kMotionOf(FindByClique(m)); }},
  };
  return guesses;
}

}  // namespace rgbd_pose
