#pragma once

#include <string>

#include "core/geometry/motion.h"

namespace rgbd_pose {

// Whether the matches determine all six directions of motion.
struct Degeneracy {
  bool is_degenerate = false;
  std::string reason;                           // names the weak direction
  MotionMatrix inverse = MotionMatrix::Zero();  // of the hessian, if it can be
};

// Judges a Gauss-Newton Hessian of [omega (rad), C (m)] that was summed over
// matches of `total_weight`. Weak is a direction
//  - whose standard deviation exceeds `max_standard_deviation` (rad or m), or
//  - on which a match tells less than a few times what noise alone feigns:
//    noisy points on a line, say, "determine" the rotation about it.
Degeneracy FindDegeneracy(const MotionMatrix& hessian, double total_weight,
                          double max_standard_deviation);

}  // namespace rgbd_pose
