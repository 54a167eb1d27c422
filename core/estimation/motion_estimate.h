#pragma once

#include <string>
#include <vector>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Whether an estimate can be trusted.
enum class EstimateStatus {
  kOk,
  kTooFewMatches,  // fewer than three usable matches
  kDegenerate,     // some direction of motion is not determined
  kNotConverged,   // the solver gave up
  kInconsistent,   // matches, or matches and a prior, do not agree
};

// The name printed by programs.
inline const char* ToString(EstimateStatus status) {
  constexpr const char* kNames[] = {"ok", "too_few_matches", "degenerate",
                                    "not_converged", "inconsistent"};
  return kNames[static_cast<int>(status)];
}

// The result of one motion estimation.
struct MotionEstimate {
  // Whether an estimate was found, and why not.
  EstimateStatus status = EstimateStatus::kTooFewMatches;
  std::string reason;  // in words; empty if ok

  // The guess if there are too few matches, no usable step, or if degenerate.
  Rigid3d cur_from_prev;

  // Covariance of [omega_x omega_y omega_z Cx Cy Cz]: omega (rad) is a small
  // rotation about the axes of the current camera, R_true = Exp(omega) R; C (m)
  // is the centre of the current camera in the axes of the previous one. Zero
  // if the motion was not judged.
  MotionMatrix covariance = MotionMatrix::Zero();

  // Per match, in the order of the Correspondences, those of the first camera
  // first: robust weight in [0, 1] (0 also for matches that no cost could use)
  // and whether the match agrees with the motion within 99 % of the noise's
  // distribution.
  std::vector<double> weights;
  std::vector<bool> is_inlier;

  // Also per match: the norm of its whitened residual at this motion, in sigmas
  // of the noise model, and its number of independent measurements. If several
  // costs use a match, the largest norm counts. Both are 0 for matches that no
  // cost could use, and for all if the motion was not judged.
  std::vector<double> residual_norms;
  std::vector<int> residual_degrees;

  int num_used = 0;     // matches that some cost could use
  int num_inliers = 0;  // of these, matches that agree

  double sigma = 0.0;  // robust spread of the whitened residuals; ideally 1
  double initial_cost = 0.0;  // robust cost at the guess in the last stage: at
                              // final loss widths, scale and weights
  double final_cost = 0.0;    // the same at the estimate
  int iterations = 0;         // of the solver, in all stages
  double solve_ms = 0.0;      // time of the whole estimation

  // Whether the motion can be trusted.
  bool ok() const { return status == EstimateStatus::kOk; }
};

}  // namespace rgbd_pose
