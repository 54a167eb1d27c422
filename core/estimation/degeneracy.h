#pragma once

#include <string>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/motion.h"

namespace rgbd_pose {

// Whether the matches determine all six directions of motion.
struct Degeneracy {
  bool is_degenerate = false;
  std::string reason;                           // names the weak direction
  MotionMatrix inverse = MotionMatrix::Zero();  // of the hessian, if it can be
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

// What the noise of the matches alone feigns to tell of a rotation, rad^-2.
// Noise moves points off a line in any direction and so gives them a lever
// about it. A lever that is itself noise tells 1 a match if the point's noise
// is equal in both directions across the axis, and
//
//   (q + 1 / q) / 2,   q = sigma_depth^2 / (depth sigma_px / fx)^2
//
// if it is along the ray and across it: the lever is long where the error is
// large, and the error is measured where it is small. `weights` of matches in
// their order; empty: 1 each.
double FeignedInformation(const Correspondences& matches,
                          const std::vector<double>& weights);

}  // namespace rgbd_pose
