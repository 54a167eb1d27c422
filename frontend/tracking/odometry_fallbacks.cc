#include <optional>
#include <string>
#include <utility>

#include "core/util/stage_timer.h"
#include "frontend/tracking/odometry.h"

// What is done where the reference does not tell a frame's pose: the frame
// before becomes one, the place is searched for, a new segment begins.

namespace rgbd_pose {

void Odometry::KeepLast(const PreparedFrame& frame,
                        const TrackedFrame& result) {
  has_last_ = result.status != TrackingStatus::kLost && !result.is_reference;
  if (!has_last_) return;
  // Memory is used again.
  cv::Mat gray = last_.frame.gray, depth = last_.frame.depth;
  frame.gray.copyTo(gray);
  frame.depth.copyTo(depth);
  last_.frame = frame;
  last_.frame.gray = gray;
  last_.frame.depth = depth;
  last_.frame.color.release();
  last_.frame.twist = twist_;
  last_.result = result;
  last_.twist_covariance = twist_covariance_;
}

// A frame that is about to become a reference should be certain of its own
// pose.
bool Odometry::IsTrusted(const PreparedFrame* frame,
                         const TrackedFrame& result) const {
  constexpr double kMaxSigma = 1.7;
  if (frame == nullptr || result.status != TrackingStatus::kOk) return false;
  return !NeedsNewReference() ||
         (result.sigma <= kMaxSigma && !attempts_.kept().is_scarce);
}

const PreparedFrame* Odometry::LookFromLast(const PreparedFrame& measured,
                                            const Prediction* prediction,
                                            const PreparedFrame* found,
                                            TrackedFrame* result) {
  Keyframe* const reference = reference_;
  const Rigid3d cur_from_ref = cur_from_ref_;
  const MotionMatrix covariance = covariance_;
  {
    const StageTimer timer(&result->reference_ms);
    if (!MakeLastReference()) return found;
  }
  result->previous_is_reference = true;
  TrackedFrame from_last = *result;
  attempts_.Stash();
  ShutterTracking::Found before = shutter_tracking_.TakeFound();
  std::optional<Prediction> since;
  if (prediction != nullptr)
    since = Predict(prediction->cur_from_prev, nullptr);
  const PreparedFrame* const frame =
      Look(measured, since ? &*since : nullptr, &from_last);
  result->match_ms = from_last.match_ms;
  result->solve_ms = from_last.solve_ms;
  const bool is_better =
      frame != nullptr &&
      (found == nullptr ||
       (from_last.status == TrackingStatus::kOk &&
        (wants_reference_ || result->status != TrackingStatus::kOk ||
         from_last.sigma < result->sigma)));
  if (is_better) {
    *result = from_last;
    return frame;
  }
  reference_ = reference;
  cur_from_ref_ = cur_from_ref;
  covariance_ = covariance;
  attempts_.TakeUpStashed();
  shutter_tracking_.PutBack(std::move(before));
  return found;
}

bool Odometry::MakeLastReference() {
  if (!has_last_) return false;
  const Frame& frame = last_.frame;
  const auto seen = shutter_tracking_.LastAtOneMoment(frame);
  std::string why_not;
  std::unique_ptr<Reference> reference =
      tracker_->MakeReference(*seen, nullptr, nullptr, &why_not);
  if (reference == nullptr) return false;
  const int id = last_.result.index;
  has_last_ = false;
  reference_ = keyframes_.Add(
      {id, segment_, last_.result.world_from_cam, std::move(reference),
       std::make_unique<Place>(*seen, id), last_.result.edges},
      reference_);
  shutter_tracking_.AddReference(frame, *seen, id);
  reference_->velocity_covariance = last_.twist_covariance;
  cur_from_ref_ = Rigid3d();
  covariance_.setZero();
  return true;
}

bool Odometry::Relocalise(const PreparedFrame& frame, TrackedFrame* result) {
  std::optional<Relocalisation> place;
  {
    const StageTimer timer(&result->relocalise_ms);
    place = relocaliser_.Find(frame, keyframes_.Places());
  }
  if (!place.has_value()) return false;
  Keyframe* keyframe = keyframes_.Find(place->place_id);
  TrackingGuess guess = place->cur_from_place;
  VelocityPrior velocity;
  if (has_shutter_) {
    velocity = shutter_tracking_.LostPrior(frame, interval_);
    guess.velocity = &velocity;
  }
  if (!attempts_.Try(frame, *keyframe, guess, result) ||
      result->status != TrackingStatus::kOk) {
    return false;
  }
  twist_ = attempts_.kept().twist;
  if (twist_.has_value()) {
    shutter_tracking_.Accept(*twist_, frame.color_shutter.offset);
  }
  reference_ = keyframe;
  segment_ = keyframe->segment;
  TakeMotion(result);
  cur_from_prev_ = Rigid3d();
  result->relocalised = true;
  Accept(frame, result);
  return true;
}

void Odometry::Lose(const PreparedFrame& frame, const Prediction* prediction,
                    TrackedFrame* result) {
  // One frame that nobody tells of, and the way since is no longer known.
  is_predicted_ = prediction != nullptr && (is_predicted_ || !is_lost_);
  is_lost_ = true;
  wants_reference_ = false;
  shutter_tracking_.Lose();
  result->status = TrackingStatus::kLost;
  result->is_predicted = is_predicted_;
  if (prediction != nullptr) {
    cur_from_prev_ = prediction->cur_from_prev;
    cur_from_ref_ = prediction->cur_from_ref;
    covariance_ = prediction->covariance;
  } else if (options_.on_lost == LostPolicy::kPredict) {
    cur_from_ref_ = cur_from_prev_ * cur_from_ref_;
  } else {
    cur_from_prev_ = Rigid3d();
  }
  if (is_predicted_) {
    result->edges = {
        {reference_->id, result->index, cur_from_ref_, covariance_}};
  }
  if (options_.on_lost != LostPolicy::kNewSegment ||
      frame.timestamp - tracked_at_ < options_.new_segment_after) {
    return;
  }
  ++segment_;
  if (!TakeReference(frame, WorldFromCam(), result)) {
    --segment_;
    return;
  }
  is_lost_ = false;
  tracked_at_ = frame.timestamp;
  result->reference = -1;
  result->status = TrackingStatus::kDegraded;
  result->reason =
      std::string("a new segment: the motion since it was lost is ") +
      (is_predicted_ ? "only predicted" : "unknown");
}

}  // namespace rgbd_pose
