#include "frontend/tracking/shutter_tracking.h"

#include <string>
#include <utility>

#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// A reference is moved if the new velocity moves its pixels by this.
constexpr double kSmallFlowPx = 0.2;

// Rounds for the first two frames: each determines the velocity of the other.
constexpr int kMaxRounds = 3;

// The velocities of the first two frames err in opposite directions. The second
// one has to fit the first, or else features contradict the motion: it counts
// with this share of the variance of the first.
constexpr double kShareOfFirst = 0.25;

// A hand moves more slowly; a wrong estimate may be faster.
constexpr double kMaxAngular = 6.0;  // rad/s
constexpr double kMaxLinear = 4.0;   // m/s

bool IsOfAHand(const Twist& twist) {
  return twist.angular.norm() < kMaxAngular && twist.linear.norm() < kMaxLinear;
}

// Between two intervals with these mean velocities, at constant acceleration.
Twist VelocityBetween(const std::optional<Twist>& before, double before_s,
                      const Twist& after, double after_s) {
  if (!before.has_value()) return after;
  const double share = before_s / (before_s + after_s);
  return share * after + (1.0 - share) * *before;
}

}  // namespace

void ShutterTracking::HandleLost() {
  between_.reset();
  found_velocity_.reset();
  found_ = Found();
  early_.reset();
}

const PreparedFrame* ShutterTracking::Follow(
    const PreparedFrame& frame, double interval,
    const std::optional<Rigid3d>& prev_from_ref,
    const std::optional<Twist>& first_guess,
    const std::optional<MeasuredTwist>& measured, OdometryKeyframe* reference,
    const TrackingResult& tracked, const Track& track,
    const TrackAgain& track_again) {
  found_ = Found();
  const auto forget = [&] {
    Forget();
    found_.frame = frame.WithTwist(std::nullopt);
    return track(*found_.frame, nullptr) ? &*found_.frame : nullptr;
  };
  if (!(interval > 0.0 && interval <= VelocityModel::kMaxAge) ||
      velocity_.IsOutdated(frame.timestamp)) {
    return forget();
  }
  const double middle = frame.color_shutter.offset;
  // Nothing is known of the velocity of the first reference yet.
  if (first_guess.has_value() && early_.has_value() &&
      !early_->velocity.has_value()) {
    MoveReference(*first_guess, MotionMatrix::Zero(), interval, reference);
  }
  VelocityPrior prior =
      PriorOf(*reference, prev_from_ref, measured, interval, middle);
  found_.frame = frame.WithTwist(first_guess ? first_guess : velocity_.last());
  if (measured.has_value()) {
    found_.frame->twist = prior.Fused(found_.frame->twist.value_or(Twist()));
  }
  if (!track(*found_.frame, &prior)) return nullptr;
  const auto look = [&] {
    if (tracked.velocity.has_value()) {
      found_.frame = frame.WithTwist(tracked.velocity->twist);
    }
    found_.prior = prior;
    found_.velocity = tracked.velocity;
    Update(tracked);
  };
  look();
  const int rounds = between_.has_value() ? 1 : kMaxRounds;
  for (int round = 0; round < rounds && found_.between.has_value(); ++round) {
    if (!MoveReference(*found_.between,
                       CovarianceInCurrentAxes(tracked.estimate, nullptr),
                       interval, reference)) {
      break;
    }
    prior = PriorOf(*reference, prev_from_ref, measured, interval, middle);
    const Rigid3d found = tracked.estimate.cur_from_prev;
    if (!track_again(*found_.frame, prior, found)) return nullptr;
    look();
    if (!early_->velocity.has_value() && found_.velocity.has_value()) {
      found_.velocity->covariance += reference->velocity_covariance;
      reference->timing_covariance =
          early_->timing_covariance + found_.velocity->motion_covariance;
    }
  }
  if (!IsOfAHand(found_.between.value_or(Twist())) ||
      !IsOfAHand(found_.frame->twist.value_or(Twist()))) {
    return forget();
  }
  found_.interval = interval;
  return &*found_.frame;
}

void ShutterTracking::Update(const TrackingResult& refined) {
  if (!found_.prior.has_value()) return;
  found_.between = found_.prior->Between(refined.estimate.cur_from_prev,
                                         found_.frame->twist.value_or(Twist()));
}

void ShutterTracking::Accept(const TrackingResult& refined) {
  early_.reset();
  acceleration_covariance_.setZero();
  if (found_.frame.has_value() && found_.frame->twist.has_value()) {
    AddVelocity(*found_.frame, *found_.frame->twist);
  }
  between_ = found_.between;
  interval_ = found_.interval;
  found_velocity_ = found_.velocity;
  motion_covariance_ = CovarianceInCurrentAxes(
      refined.estimate, refined.velocity ? &*refined.velocity : nullptr);
}

void ShutterTracking::Restart(const Frame& frame,
                              const TrackingResult& tracked) {
  HandleLost();
  if (!tracked.velocity.has_value()) return;
  AddVelocity(frame, tracked.velocity->twist);
  found_velocity_ = tracked.velocity;
  motion_covariance_ =
      CovarianceInCurrentAxes(tracked.estimate, &*found_velocity_);
}

void ShutterTracking::AddVelocity(const Frame& frame, const Twist& twist) {
  velocity_.Add(twist, frame.timestamp, frame.color_shutter.offset);
  acceleration_covariance_ =
      MotionCovarianceOfAcceleration(frame.Timing(twist), velocity_.change());
}

VelocityPrior ShutterTracking::PriorOf(
    const OdometryKeyframe& reference,
    const std::optional<Rigid3d>& prev_from_ref,
    const std::optional<MeasuredTwist>& measured, double interval,
    double middle) const {
  VelocityPrior prior = velocity_.Prior(prev_from_ref, interval, middle);
  prior.measured = measured;
  prior.reference_covariance = reference.velocity_covariance;
  const bool is_second = early_.has_value() && !early_->velocity.has_value();
  if (is_second) prior.reference_covariance *= kShareOfFirst;
  return prior;
}

SmoothedFrame ShutterTracking::SmoothReference(const Twist& since,
                                               const MotionMatrix& covariance,
                                               double interval) const {
  const bool has_before = early_->before.has_value();
  MeanVelocity mean;
  mean.twist =
      VelocityBetween(early_->before, early_->interval, since, interval);
  mean.seconds = interval + (has_before ? early_->interval : 0.0);
  const VelocityPrior prior = velocity_.Prior(Rigid3d(), interval, 0.0);
  mean.covariance =
      has_before ? velocity_.CovarianceInTheMiddle(interval)
                 : IndependentErrors(prior.sigma_angular, prior.sigma_linear);
  const double per_second = 1.0 / mean.seconds;
  mean.covariance += per_second * per_second * covariance;
  if (!early_->velocity.has_value()) return {mean.twist, mean.covariance};
  if (!has_before) {
    return Smooth(*early_->velocity, MotionMatrix::Zero(), mean);
  }
  // The frame before it has been found about as exactly.
  mean.covariance += per_second * per_second * early_->motion_covariance;
  return Smooth(*early_->velocity, early_->motion_covariance, mean);
}

bool ShutterTracking::MoveReference(const Twist& since,
                                    const MotionMatrix& covariance,
                                    double interval,
                                    OdometryKeyframe* reference) {
  if (!early_.has_value() || !IsOfAHand(since)) return false;
  const SmoothedFrame smoothed = SmoothReference(since, covariance, interval);
  const Twist& twist = smoothed.twist;
  Frame& frame = early_->frame;
  velocity_.Correct(twist, frame.timestamp);
  if (early_->before.has_value()) {
    const Twist change =
        (2.0 / (early_->interval + interval)) * (since - *early_->before);
    reference->timing_covariance =
        early_->timing_covariance +
        MotionCovarianceOfAcceleration(frame.Timing(twist), change);
  }
  // Nothing was known before: a camera that stands still is known to.
  if (!early_->velocity.has_value() && !frame.twist.has_value()) {
    reference->velocity_covariance = smoothed.covariance;
  }
  if (LargestFlow(tracker_->images().camera, frame.Timing(twist),
                  twist - frame.twist.value_or(Twist())) < kSmallFlowPx) {
    return false;
  }
  frame.twist = twist;
  // The axes of the reference stay where its pose has put them.
  const Rigid3d stamp_from_reference = Rigid3d::FromRotationVector(
      smoothed.change.head<3>(), smoothed.change.tail<3>());
  velocity_.SetMiddle(twist.MotionDuring(frame.color_shutter.offset) *
                      stamp_from_reference);
  reference->frame.twist = twist;
  reference->velocity_covariance = smoothed.covariance;
  reference->reference_from_stamp = stamp_from_reference.Inverse();
  reference->features.reset();
  tracker_->MoveReference(reference->frame, reference->reference_from_stamp,
                          reference->reference.get());
  return true;
}

void ShutterTracking::AddReference(OdometryKeyframe* reference) {
  const Frame& frame = reference->frame;
  early_ = EarlyReference{frame,
                          frame.twist ? found_velocity_ : std::nullopt,
                          motion_covariance_,
                          between_,
                          interval_,
                          reference->timing_covariance};
  for (cv::Mat* image :
       {&early_->frame.gray, &early_->frame.depth, &early_->frame.color}) {
    image->release();
  }
  reference->velocity_covariance = early_->velocity.has_value()
                                       ? early_->velocity->covariance
                                       : VelocityModel::CovarianceOfUnknown();
}

}  // namespace rgbd_pose
