#include "frontend/tracking/velocity_prior.h"

#include <algorithm>
#include <cmath>

namespace rgbd_pose {
namespace {

// Lower limits of the change of velocity per frame, for a camera on a tripod.
constexpr double kMinChangeAngular = 0.01;
constexpr double kMinChangeLinear = 0.005;

// Weight of the mean velocity since the previous frame in the expected
// velocity; the rest is the previous one's. With 1 the errors are 20 % larger.
constexpr double kShareOfBetween = 0.8;

// Standard deviations if the previous frames were not found, and upper limits
// otherwise: rad/s and m/s.
constexpr double kLostSigmaAngular = 1.0;
constexpr double kLostSigmaLinear = 0.5;

// Standard deviation of the velocity once the motion is known, as a share of
// the change of velocity from frame to frame.
constexpr double kSigmaOfChange = 0.5;

// Change of the acceleration of a hand per second, as a share of it. A rendered
// hand has 1.3 (angular) and 1.9 (linear).
constexpr double kChangeOfAcceleration = 1.7;  // 1/s

// Weight of a new value in the mean squares, which span about ten frames.
constexpr double kShareOfNew = 0.1;

// The weight of a value in the mean with one that was measured.
double ShareOfExpected(double sigma, double measured_sigma) {
  if (std::isinf(measured_sigma)) return 1.0;
  return 1.0 / (1.0 + std::pow(sigma / measured_sigma, 2));
}

// Half of the mean squared time from the stamp, s^2, through which
// accelerations move what is seen. Depth affects a motion little except along
// the optical axis.
double HalfSquare(const FrameTiming& timing) {
  constexpr double kShareOfDepth = 0.2;
  const Shutter& color = timing.color;
  const double late = timing.depth.offset - color.offset;
  return 0.5 *
         (color.offset * color.offset + color.readout * color.readout / 12.0 +
          kShareOfDepth * late * late);
}

}  // namespace

MotionMatrix IndependentErrors(double turn, double shift) {
  MotionMatrix covariance = MotionMatrix::Zero();
  covariance.diagonal().head<3>().setConstant(turn * turn);
  covariance.diagonal().tail<3>().setConstant(shift * shift);
  return covariance;
}

std::optional<Twist> VelocityPrior::Between(const Rigid3d& cur_from_ref,
                                            const Twist& twist) const {
  if (!prev_from_ref.has_value()) return std::nullopt;
  const Rigid3d cur_from_prev = twist.MotionDuring(middle) * cur_from_ref *
                                prev_from_ref->Inverse() *
                                prev_middle_from_prev.Inverse();
  return TwistOf(cur_from_prev, interval);
}

double VelocityPrior::SigmaAngular() const {
  return measured.has_value() ? measured->sigma_angular : sigma_angular;
}

double VelocityPrior::SigmaLinear() const {
  if (!measured.has_value()) return sigma_linear;
  return sigma_linear *
         std::sqrt(ShareOfExpected(sigma_linear, measured->sigma_linear));
}

Twist VelocityPrior::Fused(const Twist& expected) const {
  if (!measured.has_value()) return expected;
  const Twist& seen = measured->twist;
  const double share = ShareOfExpected(sigma_linear, measured->sigma_linear);
  Twist fused = seen;
  fused.linear += share * (expected.linear - seen.linear);
  fused.linear_acceleration *= 1.0 - share;
  return fused;
}

// The estimated velocity feeds back into its own prior. With an extrapolation
// of the last velocities (3/2 of the mean velocity minus 1/2 of the last one,
// which suits the acceleration of a hand) it oscillates until frames are lost.
Twist VelocityPrior::Mean(const Rigid3d& cur_from_ref,
                          const Twist& twist) const {
  const std::optional<Twist> between = Between(cur_from_ref, twist);
  Twist mean = prev_twist.value_or(between.value_or(Twist()));
  if (between.has_value() && prev_twist.has_value()) {
    mean = kShareOfBetween * *between + (1.0 - kShareOfBetween) * *prev_twist;
  }
  return Fused(mean);
}

MotionMatrix MotionCovarianceOfTwist(const FrameTiming& timing,
                                     double sigma_angular,
                                     double sigma_linear) {
  constexpr double kShareOfReadout = 0.25;
  const Shutter& color = timing.color;
  const double time = std::abs(color.offset) +
                      kShareOfReadout * std::abs(color.readout) +
                      std::abs(timing.depth.offset - color.offset);
  return IndependentErrors(sigma_angular * time, sigma_linear * time);
}

MotionMatrix MotionCovarianceOfAcceleration(const FrameTiming& timing,
                                            const VelocityPrior& prior) {
  const double half_square = HalfSquare(timing);
  const double per_second = 1.0 / (kSigmaOfChange * prior.interval);
  const double scale = half_square * per_second;
  double turn = scale * prior.sigma_angular;
  double shift = scale * prior.sigma_linear;
  if (prior.measured.has_value()) {
    const MeasuredTwist& seen = *prior.measured;
    turn = std::max(turn, half_square * seen.twist.angular_acceleration.norm());
    turn += seen.rest_turn;
    shift += seen.rest_shift;
  }
  return IndependentErrors(turn, shift);
}

MotionMatrix MotionCovarianceOfAcceleration(const FrameTiming& timing,
                                            const Twist& change) {
  const Eigen::Vector3d angular =
      change.angular - timing.twist.angular_acceleration;
  const Eigen::Vector3d linear =
      change.linear - timing.twist.linear_acceleration;
  const double half_square = HalfSquare(timing);
  return IndependentErrors(half_square * angular.norm(),
                           half_square * linear.norm());
}

VelocityPrior VelocityModel::Prior(const std::optional<Rigid3d>& prev_from_ref,
                                   double interval, double middle) const {
  const bool is_lost = !prev_from_ref.has_value();
  const auto sigma = [&](double acceleration, double min_change, double lost) {
    const double change = std::max(min_change, acceleration * interval);
    return is_lost ? lost : std::min(lost, kSigmaOfChange * change);
  };
  return {
      prev_from_ref,
      last_,
      interval,
      middle,
      middle_from_last_,
      sigma(std::sqrt(angular_square_), kMinChangeAngular, kLostSigmaAngular),
      sigma(std::sqrt(linear_square_), kMinChangeLinear, kLostSigmaLinear)};
}

MotionMatrix VelocityModel::CovarianceOfUnknown() {
  return IndependentErrors(kLostSigmaAngular, kLostSigmaLinear);
}

MotionMatrix VelocityModel::CovarianceInTheMiddle(double interval) const {
  const double scale = kChangeOfAcceleration * interval;
  return IndependentErrors(
      scale *
          std::max(kMinChangeAngular, std::sqrt(angular_square_) * interval),
      scale * std::max(kMinChangeLinear, std::sqrt(linear_square_) * interval));
}

void VelocityModel::Add(const Twist& twist, double timestamp, double middle) {
  change_ = Twist();
  if (last_.has_value() && timestamp > timestamp_) {
    change_ = (1.0 / (timestamp - timestamp_)) * (twist - *last_);
    angular_square_ +=
        kShareOfNew * (change_.angular.squaredNorm() / 3.0 - angular_square_);
    linear_square_ +=
        kShareOfNew * (change_.linear.squaredNorm() / 3.0 - linear_square_);
  }
  // An acceleration that was measured is that of its frame alone.
  last_ = Twist{twist.angular, twist.linear};
  timestamp_ = timestamp;
  middle_from_last_ = twist.MotionDuring(middle);
}

}  // namespace rgbd_pose
