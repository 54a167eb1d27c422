#pragma once

#include <string>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/motion.h"

namespace rgbd_pose {

// Whether the matches determine all six directions of motion.
struct Degeneracy {
  bool is_degenerate = false;
  std::string reason;                           // names the weak direction
  MotionMatrix inverse = MotionMatrix::Zero();  // of the hessian, if it can be

  // How the motion changes with the rotation that is known least, by 1 rad, and
  // what is known of it, rad^-2.
  MotionVector weakest_rotation = MotionVector::Zero();
  double known_rotation = 0.0;
};

// Judges a Gauss-Newton Hessian of [omega (rad), C (m)] by the standard
// deviations it leaves: of the rotation in rad and of the translation in m,
// each in its own unit. Weak is
//  - what exceeds `max_standard_deviation` (rad or m), and
//  - a rotation known no better than `feigned_information` (rad^-2) makes it:
//    noisy points on a line, say, "determine" the rotation about it.
Degeneracy FindDegeneracy(const MotionMatrix& hessian,
                          double feigned_information,
                          double max_standard_deviation);

// The same if of what is known of the weakest rotation only a share is.
void JudgeWeakestRotation(double share, double feigned_information,
                          double max_standard_deviation, Degeneracy* result);

// What the noise of the matches alone feigns to tell of a rotation, rad^-2.
// Noise moves points off a line in any direction and so gives them a lever
// about it. A lever that is itself noise counts 1 a match if the point's noise
// is equal in both directions across the axis, and
//
//   (q + 1 / q) / 2,   q = sigma_depth^2 / (depth sigma_px / fx)^2
//
// if it is along the ray and across it: the lever is long where the error is
// large, and the error is measured where it is small. `weights` of matches in
// their order; empty: 1 each.
double SpuriousInformation(const Correspondences& matches,
                           const std::vector<double>& weights);

// The share of what matches tell of a change of the motion that comes from
// those that agree with it, less the three that tell most: where right matches
// leave a rotation open it turns to where a wrong one agrees by chance, and
// that is a long lever.
double SupportedShare(const Correspondences& matches,
                      const MotionEstimate& estimate,
                      const MotionVector& change);

}  // namespace rgbd_pose
