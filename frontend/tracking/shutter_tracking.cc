#include "frontend/tracking/shutter_tracking.h"

#include <string>
#include <utility>

#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// A reference is moved if the new velocity moves its pixels by this.
constexpr double kSmallFlowPx = 0.2;

// The velocities of the reference and of the next frame determine each other.
constexpr int kMaxRounds = 3;

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
  found_ = Found();
  early_.reset();
}

const PreparedFrame* ShutterTracking::Follow(
    const PreparedFrame& frame, double interval,
    const std::optional<Rigid3d>& prev_from_ref,
    const std::optional<Twist>& first_guess, OdometryKeyframe* reference,
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
  if (first_guess.has_value() && early_.has_value() && early_->is_free) {
    MoveReference(*first_guess, interval, reference);
  }
  found_.frame = frame.WithTwist(first_guess ? first_guess : velocity_.last());
  VelocityPrior prior = velocity_.Prior(prev_from_ref, interval, middle);
  if (!track(*found_.frame, &prior)) return nullptr;
  const auto look = [&] {
    if (tracked.twist.has_value()) {
      found_.frame = frame.WithTwist(tracked.twist);
    }
    found_.prior = prior;
    Update(tracked);
  };
  look();
  for (int round = 0; round < kMaxRounds && found_.between.has_value();
       ++round) {
    if (!MoveReference(*found_.between, interval, reference)) break;
    prior = velocity_.Prior(prev_from_ref, interval, middle);
    const Rigid3d found = tracked.estimate.cur_from_prev;
    if (!track_again(*found_.frame, prior, found)) return nullptr;
    look();
    if (early_->is_free) {
      reference->timing_covariance =
          early_->timing_covariance + tracked.twist_covariance;
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

void ShutterTracking::Accept() {
  early_.reset();
  if (found_.frame.has_value() && found_.frame->twist.has_value()) {
    velocity_.Add(*found_.frame->twist, found_.frame->timestamp,
                  found_.frame->color_shutter.offset);
  }
  between_ = found_.between;
  interval_ = found_.interval;
}

bool ShutterTracking::MoveReference(const Twist& since, double interval,
                                    OdometryKeyframe* reference) {
  if (!early_.has_value() || !IsOfAHand(since)) return false;
  const Twist twist =
      VelocityBetween(early_->before, early_->interval, since, interval);
  Frame& frame = early_->frame;
  velocity_.Correct(twist, frame.timestamp);
  if (LargestFlow(tracker_->images().camera, frame.Timing(twist),
                  twist - frame.twist.value_or(Twist())) < kSmallFlowPx) {
    return false;
  }
  frame.twist = twist;
  const Rigid3d middle_from_stamp =
      twist.MotionDuring(frame.color_shutter.offset);
  if (early_->is_free) {
    early_->target_from_middle = middle_from_stamp.Inverse();
    velocity_.SetMiddle(middle_from_stamp);
  }
  reference->frame.twist = twist;
  reference->reference_from_stamp =
      early_->target_from_middle * middle_from_stamp;
  reference->features.reset();
  tracker_->MoveReference(reference->frame, reference->reference_from_stamp,
                          reference->reference.get());
  return true;
}

void ShutterTracking::AddReference(const Keyframe& reference) {
  const Frame& frame = reference.frame;
  early_ = EarlyReference{frame,
                          frame.twist.value_or(Twist())
                              .MotionDuring(frame.color_shutter.offset)
                              .Inverse(),
                          /*is_free=*/!frame.twist.has_value(),
                          between_,
                          interval_,
                          reference.timing_covariance};
  for (cv::Mat* image :
       {&early_->frame.gray, &early_->frame.depth, &early_->frame.color}) {
    image->release();
  }
}

}  // namespace rgbd_pose
