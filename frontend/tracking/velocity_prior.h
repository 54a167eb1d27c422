#pragma once

#include <limits>
#include <optional>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// The velocity at a frame as an inertial sensor has measured it, with the
// standard deviations of its parts. Accelerations are 0 where the velocity is
// not known.
struct MeasuredTwist {
  Twist twist;
  double sigma_angular = std::numeric_limits<double>::infinity();  // rad/s
  double sigma_linear = std::numeric_limits<double>::infinity();   // m/s

  // How far the camera is from where constant accelerations take it while rows
  // are exposed, rad and m.
  double rest_turn = 0.0;
  double rest_shift = 0.0;
};

// What is known about the camera's velocity at a frame before its rows are
// used, as a function of the motion to this frame.
struct VelocityPrior {
  // The motion of the previous frame and its velocity; nothing: unknown.
  std::optional<Rigid3d> prev_from_ref;
  std::optional<Twist> prev_twist;

  double interval = 0.0;  // since the previous frame, s

  // When the middle row is exposed, after the stamp (s). Motions are determined
  // from what is seen at this time.
  double middle = 0.0;
  Rigid3d prev_middle_from_prev;  // of the previous frame, as corrected

  // Standard deviations of the velocity once the motion is known.
  double sigma_angular = 0.0;  // rad/s
  double sigma_linear = 0.0;   // m/s

  // Nothing: there is no inertial sensor.
  std::optional<MeasuredTwist> measured = std::nullopt;

  // Standard deviations of the velocity once the motion is known and the sensor
  // is asked, rad/s and m/s.
  double SigmaAngular() const;
  double SigmaLinear() const;

  // What an expected velocity, without accelerations, becomes by what was
  // measured: the angular part of that, as no history foresees a sudden turn,
  // and the mean of both linear parts, weighted with standard deviations.
  Twist Fused(const Twist& expected) const;

  // Covariance of the velocity (angular, then linear) according to which the
  // points of the reference have been moved.
  MotionMatrix reference_covariance = MotionMatrix::Zero();

  // The mean velocity since the previous frame, and the velocity expected at
  // this frame. `twist`: the velocity with which the motion was found.
  std::optional<Twist> Between(const Rigid3d& cur_from_ref,
                               const Twist& twist) const;
  Twist Mean(const Rigid3d& cur_from_ref, const Twist& twist) const;
};

// Returns the covariance of a motion whose errors in all directions are
// independent, with these standard deviations (rad, m).
MotionMatrix IndependentErrors(double turn, double shift);

// Returns what a velocity with these standard deviations (rad/s, m/s) adds to
// the covariance (see MotionEstimate) of the motion to a frame corrected with
// it: the mean time of the rows differs from the stamp by their offset, by a
// part of the readout time and by the delay of depth.
MotionMatrix MotionCovarianceOfTwist(const FrameTiming& timing,
                                     double sigma_angular, double sigma_linear);

// Returns the covariance that accelerations within a frame add to the motion.
// Their size follows from the prior's change of velocity between frames, and
// from what was measured of this one. A frame that is corrected with measured
// accelerations errs less than that, but not where the hand is so fast that
// images are blurred, and there the covariance has to hold.
MotionMatrix MotionCovarianceOfAcceleration(const FrameTiming& timing,
                                            const VelocityPrior& prior);

// Returns what an acceleration adds that the frame was not corrected with.
// `change`: of the velocity, in a second.
MotionMatrix MotionCovarianceOfAcceleration(const FrameTiming& timing,
                                            const Twist& change);

// The camera's velocity from frame to frame.
class VelocityModel {
 public:
  // Forgets everything: after a loss, a jump or a gap.
  void Reset() { *this = VelocityModel(); }

  // Velocities older than this, and motions over longer intervals, tell nothing
  // about the velocity of a frame.
  static constexpr double kMaxAge = 0.5;  // s
  bool IsOutdated(double timestamp) const {
    return last_.has_value() && !(timestamp - timestamp_ <= kMaxAge);
  }

  // The velocity of the last frame; nothing if it is unknown.
  const std::optional<Twist>& last() const { return last_; }

  // The prior of the next frame, `interval` s later. `prev_from_ref`: motion of
  // the last frame; nothing: it was not found.
  VelocityPrior Prior(const std::optional<Rigid3d>& prev_from_ref,
                      double interval, double middle) const;

  // Covariance of the velocity (angular, then linear) of a hand of which
  // nothing is known.
  static MotionMatrix CovarianceOfUnknown();

  // Covariance of the velocity (angular, then linear) of the last frame if it
  // is the mean of those before and after it, over about `interval` s each.
  MotionMatrix CovarianceInTheMiddle(double interval) const;

  // How much the velocity has changed since the frame before, per second; 0 if
  // that is unknown.
  const Twist& change() const { return change_; }

  // Adds the velocity of the next frame, which was corrected with it.
  void Add(const Twist& twist, double timestamp, double middle);

  // Sets the velocity of the last frame, which is better known now.
  void Correct(const Twist& twist, double timestamp) {
    last_ = Twist{twist.angular, twist.linear};
    timestamp_ = timestamp;
  }
  // Call this if the last frame was corrected with another velocity.
  void SetMiddle(const Rigid3d& middle_from_last) {
    middle_from_last_ = middle_from_last;
  }

 private:
  std::optional<Twist> last_;
  double timestamp_ = 0.0;  // of the last velocity, s
  Twist change_;            // per second
  Rigid3d middle_from_last_;
  // Mean squares of the accelerations; initial values for a hand.
  double angular_square_ = 6.0 * 6.0;  // (rad/s^2)^2
  double linear_square_ = 3.0 * 3.0;   // (m/s^2)^2
};

}  // namespace rgbd_pose
