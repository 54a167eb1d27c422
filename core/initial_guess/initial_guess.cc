#include "core/initial_guess/initial_guess.h"

#include "core/initial_guess/consensus.h"
#include "core/util/named_values.h"

namespace rgbd_pose {
namespace {

std::optional<Rigid3d> MotionOf(const std::optional<Consensus>& consensus) {
  if (!consensus) return std::nullopt;
  return consensus->cur_from_prev;
}

std::optional<Rigid3d> Identity(const Correspondences& /*matches*/) {
  return Rigid3d();
}

std::optional<Rigid3d> ByRansac(const Correspondences& matches) {
  return MotionOf(FindByRansac(matches));
}

std::optional<Rigid3d> ByClique(const Correspondences& matches) {
  return MotionOf(FindByClique(matches));
}

}  // namespace

const std::vector<InitialGuess>& InitialGuesses() {
  static const std::vector<InitialGuess>& guesses =
      *new std::vector<InitialGuess>{
          {"identity", Identity},
          {"ransac", ByRansac},
          {"clique", ByClique},
      };
  return guesses;
}

const InitialGuess* FindInitialGuess(std::string_view name) {
  return FindNamed(InitialGuesses(), name);
}

}  // namespace rgbd_pose
