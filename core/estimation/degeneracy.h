#pragma once

#include <string>
#include <vector>

#include "core/estimation/camera_mounting.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/motion.h"

namespace rgbd_pose {

// Whether the matches determine all six directions of motion.
struct Degeneracy {
  std::string reason;  // names the weak direction; empty if there is none
  MotionMatrix inverse = MotionMatrix::Zero();  // of the Hessian, or zero

  // The change of the motion with the least determined rotation, per 1 rad, and
  // the information on this rotation, rad^-2.
  MotionVector weakest_rotation = MotionVector::Zero();
  double known_rotation = 0.0;

  bool is_degenerate() const { return !reason.empty(); }
};

// Judges a Gauss-Newton Hessian of [omega (rad), C (m)] by the resulting
// standard deviations of the rotation in rad and of the translation in m, each
// in its own unit. The motion is degenerate if
//  - a standard deviation exceeds `max_standard_deviation` (rad or m), or
//  - the information on a rotation is below 3 times `spurious_information`
//    (rad^-2): noisy points on a line, say, "determine" the rotation about it.
Degeneracy FindDegeneracy(const MotionMatrix& hessian,
                          double spurious_information,
                          double max_standard_deviation);

// The same for the weakest rotation, known by inliers without the three that
// contribute most. If the right matches leave a rotation open, the estimate
// turns until a wrong match, of a long lever, agrees by chance. `by_pixels`:
// the part of known_rotation that comes from pixels: these are many and count
// in full, unlike a prior, which gives way to such a match.
void JudgeWeakestRotation(const std::vector<CameraMatches>& cameras,
                          const MotionEstimate& estimate, double by_pixels,
                          double spurious_information,
                          double max_standard_deviation, Degeneracy* result);

// The information on a rotation that the noise of the matches alone would
// produce, rad^-2. Noise moves points off a line and thus gives them a lever
// about the line. A match contributes 1 if its noise is equal in both
// directions across the axis, and
//
//   (q + 1 / q) / 2,   q = sigma_depth^2 / (depth sigma_px / fx)^2
//
// if these are along the ray and across it: the lever is long where the error
// is large, and the error is measured where it is small. `weights` of the
// matches of all cameras in their order; empty: 1 each.
double SpuriousInformation(const std::vector<CameraMatches>& cameras,
                           const std::vector<double>& weights);

}  // namespace rgbd_pose
