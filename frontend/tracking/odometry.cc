#include "frontend/tracking/odometry.h"

#include <cmath>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/stage_timer.h"

namespace rgbd_pose {
namespace {

// An earlier reference is used again if at least this share of it is in view,
// with at most this displacement (as a share of max_flow_px). Otherwise it
// would soon have to be replaced again.
constexpr double kMinReturnShare = 0.7;
constexpr double kMaxReturnFlow = 0.5;

// If an interval is this many times the previous one, frames are missing. Above
// the second limit (s), the velocity of a hand-held camera predicts nothing.
constexpr double kMissingFrames = 1.5;
constexpr double kMaxMovedOn = 0.2;

// After a frame with fewer features that agree, pixels are needed at once.
constexpr int kFewFeatures = 40;

// Standard deviations of an unknown velocity of a hand-held camera.
constexpr double kSigmaAngular = 0.5;  // rad/s
constexpr double kSigmaLinear = 0.3;   // m/s

// Uncertainty of the capture time of a pixel, s. Known shutters: the effect of
// blur and stamps. Others: the effect of a Kinect's shutter. Without this, up
// to 27 % of the ok frames are wrong by more than five sigmas, with it 1 %.
constexpr double kSigmaKnownTime = 3e-5;
constexpr double kSigmaUnknownTime = 5e-3;

// A wrong stamp of depth moves the pose by less than what it moves the depths,
// as colours hold it: by a quarter to a half in simulated recordings.
constexpr double kShareOfDepth = 0.4;

// With wrong exposure times of rows, a turn looks like a translation by this
// much (m per rad): a part of the displacement of objects in a room.
constexpr double kShiftOfTurn = 0.5;

// Neighbouring features err alike where the motion is a compromise between
// those of two parts of the view. Cameras differ in how much they do so anyway:
// a frame is compared with what nine tenths of the frames before stayed below.
constexpr double kMaxInflation = 4.0;
constexpr double kInflationUp = 1.05, kInflationDown = 0.995;  // by each frame

}  // namespace

std::string OdometryOptions::Check() const {
  if (!(min_reference_share <= 1.0)) {
    return "min_reference_share must not be above 1";
  }
  if (!(max_flow_px > 0.0)) return "max_flow_px must be positive";
  if (!(max_time_shift > 0.0)) return "max_time_shift must be positive";
  if (!(new_segment_after >= 0.0)) {
    return "new_segment_after must not be negative";
  }
  if (!(guess_sigma_rotation > 0.0) || !(guess_sigma_translation > 0.0)) {
    return "the guess's standard deviations must be positive";
  }
  return "";
}

Odometry::Odometry(const OdometryOptions& options,
                   std::unique_ptr<Tracker> tracker)
    : options_(options),
      tracker_(std::move(tracker)),
      relocaliser_(tracker_->images()),
      attempts_(tracker_.get()),
      state_(tracker_.get()) {
  RequireSound(options.Check(), "odometry: ");
}

TrackedFrame Odometry::Track(const Frame& frame,
                             const Rigid3d* cur_from_prev_guess,
                             const MotionMatrix* guess_covariance) {
  return Track(PreparedFrame(frame.Clone()), cur_from_prev_guess,
               guess_covariance);
}

TrackedFrame Odometry::Track(const PreparedFrame& measured,
                             const Rigid3d* cur_from_prev_guess,
                             const MotionMatrix* guess_covariance) {
  PreparedFrame frame = measured;
  const Camera& camera = tracker_->images().camera;
  const cv::Size size(camera.width, camera.height);
  if (frame.gray.size() != size || frame.depth.size() != size) {
    throw InputError(
        Format("odometry: grey and depth image must have the size of the "
               "camera, %d x %d",
               size.width, size.height));
  }
  TrackedFrame result;
  result.index = num_frames_++;
  result.timestamp = frame.timestamp;
  const double last_interval = state_.interval;
  state_.interval = result.index > 0 ? frame.timestamp - state_.timestamp : 0.0;
  // Across missing frames, the motion at constant velocity is longer.
  if (last_interval > 0.0 && state_.interval > 0.0 &&
      state_.interval < kMaxMovedOn &&
      (state_.interval > kMissingFrames * last_interval ||
       last_interval > kMissingFrames * state_.interval)) {
    state_.cur_from_prev = TwistOf(state_.cur_from_prev, last_interval)
                               .MotionDuring(state_.interval);
  }
  state_.timestamp = frame.timestamp;
  state_.stamp_jitter.Add(frame.depth_delay, state_.interval);
  state_.has_shutter = HasShutter(frame);
  state_.twist.reset();
  state_.twist_covariance.setZero();
  state_.aligns_depth =
      std::sqrt(state_.timing_covariance(5, 5)) < options_.max_time_shift;
  if (state_.has_shutter) {
    state_.twist_covariance = MotionCovarianceOfTwist(
        frame.Timing(Twist()), kSigmaAngular, kSigmaLinear);
  }
  state_.timing_covariance = TimingCovariance(
      frame, {{kSigmaAngular, 0.0, 0.0}, {kSigmaLinear, 0.0, 0.0}});
  {
    const StageTimer timer(&result.track_ms);
    if (!state_.carried.empty()) {
      frame.depth = state_.carried.WithoutRegion(frame.depth);
    }
    std::optional<Prediction> prediction;
    if (cur_from_prev_guess != nullptr) {
      prediction = Predict(*cur_from_prev_guess, guess_covariance);
    }
    if (state_.reference == nullptr) {
      if (TakeReference(frame, WorldFromCam(), &result)) {
        result.status = TrackingStatus::kOk;
      }
    } else if (state_.is_lost && options_.on_lost == LostPolicy::kStop) {
      result.reason = "stopped after an earlier frame was lost";
    } else if (!Follow(frame, prediction, &result) &&
               !Relocalise(frame, &result)) {
      HandleLost(frame, prediction, &result);
    }
  }
  result.world_from_cam = WorldFromCam();
  result.segment = state_.segment;
  if (state_.earlier_segment.has_value() &&
      result.status == TrackingStatus::kOk) {
    result.status = TrackingStatus::kDegraded;
    result.reason = "not yet reconnected to the previous segment";
  }
  // With ignored shutters, all of a fast camera's frames err so.
  if (options_.shutter == ShutterUse::kCamera) JudgeInflation(&result);
  if (result.status == TrackingStatus::kOk) {
    const OdometryKeyframe* const reference = FindKeyframe(result.reference);
    if (reference != nullptr) {
      state_.carried.Learn(reference->frame, frame, camera,
                           result.cur_from_reference);
    }
  }
  state_.last.reset();
  if (result.status != TrackingStatus::kLost && !result.is_reference) {
    state_.last = {result.index,
                   state_.segment,
                   result.world_from_cam,
                   frame.WithTwist(state_.twist),
                   {},
                   {},
                   state_.twist_covariance + state_.timing_covariance};
  }
  return result;
}

void Odometry::JudgeInflation(TrackedFrame* result) {
  state_.is_doubtful = attempts_.kept().is_ambiguous;
  // A failed attempt says nothing of the camera.
  if (result->status == TrackingStatus::kLost || result->reference < 0 ||
      result->source == TrackingSource::kDirect) {
    return;
  }
  const double inflation = attempts_.kept().covariance_factor;
  if (result->status == TrackingStatus::kOk &&
      inflation > kMaxInflation * state_.usual_inflation) {
    state_.is_doubtful = true;
    result->status = TrackingStatus::kDegraded;
    result->reason =
        "neighbouring features err alike: something moves, or the shutter is "
        "not known";
  }
  const double change =
      inflation > state_.usual_inflation ? kInflationUp : kInflationDown;
  state_.usual_inflation = std::max(1.0, change * state_.usual_inflation);
}

MotionMatrix Odometry::TimingCovariance(const Frame& frame,
                                        const Twist& twist) const {
  const bool is_known =
      options_.shutter == ShutterUse::kCamera && frame.HasKnownTimes();
  const double sigma =
      is_known ? std::hypot(kSigmaKnownTime,
                            kShareOfDepth * state_.stamp_jitter.sigma())
               : kSigmaUnknownTime;
  const double turn = twist.angular.norm();
  const double shift = twist.linear.norm() + kShiftOfTurn * turn;
  return IndependentErrors(sigma * turn, sigma * shift);
}

Odometry::Prediction Odometry::Predict(const Rigid3d& cur_from_prev,
                                       const MotionMatrix* covariance) const {
  const MotionMatrix usual = IndependentErrors(
      options_.guess_sigma_rotation, options_.guess_sigma_translation);
  return {cur_from_prev, cur_from_prev * state_.cur_from_ref,
          ComposedCovariance(cur_from_prev,
                             covariance != nullptr ? *covariance : usual,
                             state_.cur_from_ref, state_.covariance),
          covariance};
}

bool Odometry::Follow(const PreparedFrame& measured,
                      const std::optional<Prediction>& prediction,
                      TrackedFrame* result) {
  state_.aligned = AlignToLast(measured, prediction);
  if (!state_.aligned.has_value()) {
    state_.effort = Effort::kEverything;
  } else if (state_.has_few_features) {
    state_.effort = Effort::kPixels;
  } else {
    state_.effort = Effort::kQuick;
  }
  // Pixels confirm features from where these were searched for.
  const auto refine = [&](const PreparedFrame* seen) {
    if (seen == nullptr || !attempts_.kept().needs_refinement) return;
    const Rigid3d start =
        state_.aligned.value_or(Rigid3d()) * state_.cur_from_ref;
    attempts_.Refine(*seen, *state_.reference, GuessOf(start), result);
    state_.shutter_tracking.Update(attempts_.kept());
  };
  const PreparedFrame* frame = Look(measured, prediction, result);
  if (state_.effort == Effort::kPixels) refine(frame);
  if (!state_.is_lost && !IsTrusted(frame, *result)) {
    frame = LookFromLast(measured, prediction, frame, result);
  }
  while (frame == nullptr && state_.effort != Effort::kEverything) {
    state_.effort =
        state_.effort == Effort::kQuick ? Effort::kPixels : Effort::kEverything;
    frame = Look(measured, prediction, result);
  }
  refine(frame);
  // A doubtful pose does not end the lost state.
  if (frame == nullptr ||
      (state_.is_lost && result->status != TrackingStatus::kOk)) {
    return false;
  }
  const TrackingResult& tracked = attempts_.kept();
  state_.has_few_features = tracked.source == TrackingSource::kDirect ||
                            tracked.estimate.num_inliers < kFewFeatures;
  state_.twist = frame->twist;
  if (tracked.velocity.has_value()) {
    state_.twist_covariance = tracked.velocity->motion_covariance;
  }
  state_.cur_from_prev = state_.is_lost ? Rigid3d()
                                        : last_estimate().cur_from_prev *
                                              state_.cur_from_ref.Inverse();
  if (!state_.is_lost && state_.interval > 0.0) {
    state_.timing_covariance = TimingCovariance(
        measured, TwistOf(state_.cur_from_prev, state_.interval));
  }
  TakeMotion(result);
  if (state_.has_shutter) state_.shutter_tracking.Accept(tracked);
  if (state_.earlier_segment.has_value()) {
    ReturnToEarlierSegment(*frame, result);
  }
  Accept(*frame, result);
  return true;
}

std::optional<Rigid3d> Odometry::AlignToLast(
    const PreparedFrame& frame, const std::optional<Prediction>& prediction) {
  if (state_.is_lost || state_.is_doubtful) return std::nullopt;
  const Keyframe* last = nullptr;
  if (state_.last.has_value()) {
    last = &*state_.last;
  } else if (state_.reference->id == num_frames_ - 2) {
    last = state_.reference;
  }
  if (last == nullptr) return std::nullopt;
  PreparedFrame seen = frame;
  seen.twist = last->frame.twist;
  return tracker_->AlignCoarsely(last->frame, seen,
                                 prediction.has_value()
                                     ? prediction->cur_from_prev
                                     : state_.cur_from_prev);
}

// Tracks from where coarse images say that the camera is. Where they do not say
// it, from the last pose, and only then from a constant velocity, which can
// lock onto its own false motion.
const PreparedFrame* Odometry::Look(const PreparedFrame& measured,
                                    const std::optional<Prediction>& prediction,
                                    TrackedFrame* result) {
  Rigid3d first = state_.cur_from_ref;
  Rigid3d second = state_.cur_from_prev * state_.cur_from_ref;
  std::optional<Rigid3d> aligned;
  if (state_.aligned.has_value()) {
    aligned = *state_.aligned * state_.cur_from_ref;
  }
  const auto track = [&](const PreparedFrame& frame,
                         const VelocityPrior* velocity) {
    const auto from = [&](const Rigid3d& cur_from_ref) {
      TrackingGuess guess = GuessOf(cur_from_ref);
      guess.velocity = velocity;
      guess.leaves_refinement = state_.effort != Effort::kEverything;
      return guess;
    };
    if (prediction.has_value()) {
      TrackingGuess guess = from(prediction->cur_from_ref);
      if (prediction->given != nullptr) {
        guess.covariance = &prediction->covariance;
      }
      guess.search_at = aligned;
      if (attempts_.Try(frame, *state_.reference, guess, result)) return true;
    }
    TrackingGuess start = from(first);
    if (state_.effort != Effort::kEverything) {
      start.search_at = aligned;
      start.is_tentative = state_.effort == Effort::kQuick;
      return attempts_.Try(frame, *state_.reference, start, result) &&
             !attempts_.kept().is_partial;
    }
    const TrackingGuess other = from(second);
    return attempts_.TryInTurn(
        frame, *state_.reference, start, other,
        [&](Rigid3d* cur_from_ref) {
          const StageTimer timer(&result->relocalise_ms);
          return relocaliser_.FindIn(frame, state_.reference, cur_from_ref);
        },
        result);
  };
  if (!state_.has_shutter) {
    // A frame without a shutter among frames with one does not determine a
    // velocity, and the known velocity is older than this frame.
    state_.shutter_tracking.Forget();
    return track(measured, nullptr) ? &measured : nullptr;
  }
  const auto track_again = [&](const PreparedFrame& frame,
                               const VelocityPrior& velocity,
                               const Rigid3d& cur_from_ref) {
    TrackingGuess guess = GuessOf(cur_from_ref);
    guess.velocity = &velocity;
    guess.leaves_refinement = true;
    return attempts_.TryAgain(frame, *state_.reference, guess, result);
  };
  std::optional<Twist> twist;
  if (state_.interval > 0.0) {
    if (prediction.has_value()) {
      twist = TwistOf(prediction->cur_from_prev, state_.interval);
    } else if (state_.aligned.has_value() &&
               !state_.shutter_tracking.velocity()->last().has_value()) {
      twist = TwistOf(*state_.aligned, state_.interval);
    }
  }
  std::optional<Rigid3d> prev_from_ref;
  if (!state_.is_lost) prev_from_ref = state_.cur_from_ref;
  return state_.shutter_tracking.Follow(measured, state_.interval,
                                        prev_from_ref, twist, state_.reference,
                                        attempts_.kept(), track, track_again);
}

void Odometry::TakeMotion(TrackedFrame* result) {
  const MotionEstimate& estimate = last_estimate();
  state_.cur_from_ref = estimate.cur_from_prev;
  state_.covariance = estimate.covariance;
  if (!attempts_.kept().velocity.has_value()) {
    state_.covariance += state_.twist_covariance;
  }
  state_.covariance +=
      state_.timing_covariance + state_.reference->timing_covariance;
  result->cur_from_reference = state_.cur_from_ref;
  if (!HasMotion(estimate)) return;
  result->edges.insert(result->edges.begin(),
                       {state_.reference->id, result->index,
                        state_.cur_from_ref, state_.covariance});
}

void Odometry::Accept(const PreparedFrame& frame, TrackedFrame* result) {
  state_.is_lost = false;
  state_.is_unconnected = false;
  tracker_->OnAccepted(state_.reference->reference.get(),
                       attempts_.mutable_kept());
  if (!NeedsNewReference()) return;
  const Rigid3d world_from_cam = WorldFromCam();
  OdometryKeyframe* const earlier = keyframes_.FindNearest(
      world_from_cam, state_.segment, kMinReturnShare,
      kMaxReturnFlow * options_.max_flow_px, state_.reference);
  if (earlier != nullptr &&
      attempts_.TryFallback(
          frame, *earlier,
          GuessOf(world_from_cam.Inverse() * earlier->world_from_cam), result,
          [&] { return !NeedsNewReference(); })) {
    state_.reference = earlier;
    TakeMotion(result);
    return;
  }
  TakeReference(frame, world_from_cam, result);
}

bool Odometry::NeedsNewReference() const {
  const TrackingResult& tracked = attempts_.kept();
  return tracked.needs_new_keyframe ||
         tracked.overlap.share < options_.min_reference_share ||
         tracked.overlap.flow_px > options_.max_flow_px;
}

bool Odometry::TakeReference(const PreparedFrame& frame,
                             const Rigid3d& world_from_cam,
                             TrackedFrame* result) {
  const StageTimer timer(&result->reference_ms);
  const bool is_lost = result->status == TrackingStatus::kLost;
  const bool was_tracked = state_.reference != nullptr && !is_lost;
  std::string why_not;
  MotionMatrix covariance = state_.timing_covariance;
  if (frame.twist.has_value()) covariance += state_.twist_covariance;
  OdometryKeyframe* const added =
      AddKeyframe({result->index,
                   state_.segment,
                   world_from_cam,
                   frame,
                   {},
                   {},
                   covariance},
                  was_tracked ? state_.reference->reference.get() : nullptr,
                  nullptr, &why_not);
  if (added == nullptr) {
    if (is_lost) result->reason = why_not;
    return false;
  }
  state_.reference = added;
  if (state_.has_shutter) state_.shutter_tracking.AddReference(added);
  state_.cur_from_ref = Rigid3d();
  state_.covariance.setZero();
  result->is_reference = true;
  return true;
}

OdometryKeyframe* Odometry::AddKeyframe(Keyframe keyframe,
                                        const Reference* last,
                                        const OdometryKeyframe* in_use,
                                        std::string* why_not) {
  std::unique_ptr<Reference> reference = tracker_->MakeReference(
      keyframe.frame, last, last != nullptr ? &attempts_.kept() : nullptr,
      why_not);
  if (reference == nullptr) return nullptr;
  keyframe.frame.color.release();
  return keyframes_.Add({std::move(keyframe), std::move(reference)}, in_use);
}

bool Odometry::InsertKeyframe(const Keyframe& inserted) {
  OdometryKeyframe* keyframe = keyframes_.Find(inserted.id);
  if (keyframe == nullptr) {
    std::string why_not;
    Keyframe added = inserted;
    added.segment = state_.segment;
    added.frame = inserted.Unpacked();
    added.images = {};
    return AddKeyframe(std::move(added), nullptr, state_.reference, &why_not) !=
           nullptr;
  }
  if (keyframe == state_.reference) return true;
  keyframe->world_from_cam = inserted.world_from_cam;
  keyframe->segment = state_.segment;
  keyframes_.Renew(keyframe);
  return true;
}

Rigid3d Odometry::WorldFromCam() const {
  if (state_.reference == nullptr) return Rigid3d();
  return state_.reference->world_from_cam * state_.cur_from_ref.Inverse();
}

}  // namespace rgbd_pose
