#pragma once

#include <optional>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// What is known of the camera's velocity at a frame before its rows tell, as a
// function of the motion to it.
struct VelocityPrior {
  // The motion of the last frame before it, and its velocity; nothing: not
  // known.
  std::optional<Rigid3d> prev_from_ref;
  std::optional<Twist> prev_twist;

  double interval = 0.0;  // since then, s

  // When the middle row is exposed, after the stamp (s). Motions are told by
  // what is seen then.
  double middle = 0.0;
  Rigid3d prev_middle_from_prev;  // of the last frame, as it was moved

  // Standard deviations of the velocity once the motion is known.
  double sigma_angular = 0.0;  // rad/s
  double sigma_linear = 0.0;   // m/s

  // The mean velocity since the last frame, and what is to be expected at this
  // one. `twist`: that the motion was found with.
  std::optional<Twist> Between(const Rigid3d& cur_from_ref,
                               const Twist& twist) const;
  Twist Mean(const Rigid3d& cur_from_ref, const Twist& twist) const;
};

// What a velocity with such standard deviations (rad/s, m/s) adds to the
// covariance of the motion to a frame that is moved by it, as
// MotionEstimate::covariance has it: rows are seen at a mean time that is off
// by some part of the readout, and by what depth is off.
MotionMatrix MotionCovarianceOfTwist(const FrameTiming& timing,
                                     double sigma_angular, double sigma_linear);

// What is left of the error of a motion to a frame of a camera that moves like
// that, where what it sees is of its stamp to within so many seconds.
MotionMatrix MotionCovarianceOfTiming(const Twist& twist, double sigma_s);

// What accelerations within a frame add to it: the velocity changes from row to
// row by as much as the prior says from frame to frame.
MotionMatrix MotionCovarianceOfAcceleration(const FrameTiming& timing,
                                            const VelocityPrior& prior);

// The camera's velocity from frame to frame.
class VelocityModel {
 public:
  // Nothing is known any more: after a loss, a jump, a gap.
  void Reset() { *this = VelocityModel(); }

  // Velocities that are older than this (s) do not count.
  static constexpr double kMaxInterval = 0.1;

  // That of the last frame; nothing if it is not known.
  const std::optional<Twist>& last() const { return last_; }

  // Of the next frame, `interval` s later; `prev_from_ref`: of the last one;
  // nothing: that was not found.
  VelocityPrior Prior(const std::optional<Rigid3d>& prev_from_ref,
                      double interval, double middle) const;

  // That of the next frame, which was moved by it.
  void Add(const Twist& twist, double middle);

  // The last frame's is known better.
  void Correct(const Twist& twist) { last_ = twist; }
  // The last frame was moved by another one.
  void SetMiddle(const Rigid3d& middle_from_last) {
    middle_from_last_ = middle_from_last;
  }

 private:
  std::optional<Twist> last_;
  Rigid3d middle_from_last_;
  // Mean squares of its change from frame to frame, at first those of a hand.
  double change_angular_ = 0.2 * 0.2;  // (rad/s)^2
  double change_linear_ = 0.1 * 0.1;   // (m/s)^2
};

}  // namespace rgbd_pose
