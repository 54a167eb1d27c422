#include "frontend/tracking/shutter_tracking.h"

#include <string>
#include <utility>

#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// A reference is rebuilt if the new velocity moves pixels by the first limit,
// or by the second if it was made after the next frame had been tracked.
constexpr double kSmallFlowPx = 0.2;
constexpr double kSmallFlowPxOfLate = 1.0;

// Rounds for the first two frames: each determines the velocity of the other.
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

// Returns the pose of the camera for which a frame is resampled, relative to
// the camera at the exposure of the middle row. This is the camera at the stamp
// according to the velocity found with the pose of the frame.
Rigid3d TargetFromMiddle(const Frame& frame) {
  return frame.twist.value_or(Twist())
      .MotionDuring(frame.color_shutter.offset)
      .Inverse();
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
    const TrackingResult& tracked, const Track& track) {
  found_ = Found();
  const auto forget = [&] {
    Forget();
    found_.frame = frame.WithTwist(std::nullopt);
    return track(*found_.frame, nullptr, nullptr) ? &*found_.frame : nullptr;
  };
  if (!(interval > 0.0 && interval <= VelocityModel::kMaxAge) ||
      velocity_.IsOutdated(frame.timestamp)) {
    return forget();
  }
  const double middle = frame.color_shutter.offset;
  found_.frame = frame.WithTwist(first_guess ? first_guess : velocity_.last());
  VelocityPrior prior = velocity_.Prior(prev_from_ref, interval, middle);
  if (!track(*found_.frame, &prior, nullptr)) return nullptr;
  const auto look = [&] {
    if (tracked.twist.has_value()) {
      found_.frame = frame.WithTwist(tracked.twist);
    }
    found_.prior = prior;
    Update(tracked);
  };
  look();
  const int rounds = between_.has_value() ? 1 : kMaxRounds;
  for (int round = 0; round < rounds && found_.between.has_value(); ++round) {
    if (!MendReference(*found_.between, interval, reference)) break;
    prior = velocity_.Prior(prev_from_ref, interval, middle);
    const Rigid3d found = tracked.estimate.cur_from_prev;
    if (!track(*found_.frame, &prior, &found)) return nullptr;
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

bool ShutterTracking::MendReference(const Twist& since, double interval,
                                    OdometryKeyframe* reference) {
  if (!early_.has_value()) return false;
  const Twist twist =
      VelocityBetween(early_->before, early_->interval, since, interval);
  Frame& frame = early_->frame;
  velocity_.Correct(twist, frame.timestamp);
  if (LargestFlow(tracker_->images().camera, frame.Timing(twist),
                  twist - frame.twist.value_or(Twist())) <
      (early_->is_late ? kSmallFlowPxOfLate : kSmallFlowPx)) {
    return false;
  }
  frame.twist = twist;
  if (early_->is_free) {
    early_->target_from_middle = TargetFromMiddle(frame);
    velocity_.SetMiddle(early_->target_from_middle.Inverse());
  }
  const PreparedFrame moved = Rectified(frame, early_->target_from_middle);
  std::string why_not;
  auto mended = tracker_->MakeReference(moved, nullptr, nullptr, &why_not);
  if (mended == nullptr) return false;
  reference->reference = std::move(mended);
  reference->frame = moved;
  reference->features.reset();
  return true;
}

PreparedFrame ShutterTracking::Rectified(Frame frame,
                                         const Rigid3d& target_from_middle) {
  frame.color.release();  // trackers do not use colours
  return PreparedFrame(rectifier_.Rectify(frame, target_from_middle));
}

PreparedFrame ShutterTracking::AtOneMoment(const Frame& frame) {
  return Rectified(frame, TargetFromMiddle(frame));
}

PreparedFrame ShutterTracking::LastAtOneMoment(const Frame& last) {
  if (!found_.between.has_value()) return AtOneMoment(last);
  Frame frame = last;
  frame.twist =
      VelocityBetween(between_, interval_, *found_.between, found_.interval);
  return Rectified(frame, TargetFromMiddle(last));
}

void ShutterTracking::AddReference(const Frame& frame,
                                   const Keyframe& reference) {
  early_ = EarlyReference{frame,
                          TargetFromMiddle(frame),
                          /*is_free=*/!frame.twist.has_value(),
                          /*is_late=*/found_.between.has_value(),
                          between_,
                          interval_,
                          reference.timing_covariance};
  early_->frame.color.release();
  early_->frame.twist = reference.frame.twist;
}

}  // namespace rgbd_pose
