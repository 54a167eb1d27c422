#include "core/initial_guess/initial_guess.h"

#include "core/initial_guess/consensus.h"
#include "core/util/named_values.h"

namespace rgbd_pose {
namespace {

std::optional<Rigid3d> MotionOf(const std::optional<Consensus>& consensus) {
  if (!consensus) return std::nullopt;
  return consensus->cur_from_prev;
}

}  // namespace

const std::vector<InitialGuess>& InitialGuesses() {
  static const auto& guesses = *new std::vector<InitialGuess>{
      {"identity", [](const auto&) { return std::optional(Rigid3d()); }},
      {"ransac", [](const auto& m) { return MotionOf(FindByRansac(m)); }},
      {"clique", [](const auto& m) { return MotionOf(FindByClique(m)); }},
  };
  return guesses;
}

const InitialGuess* FindInitialGuess(std::string_view name) {
  return FindNamed(InitialGuesses(), name);
}

}  // namespace rgbd_pose
