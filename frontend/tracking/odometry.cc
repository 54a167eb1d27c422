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
      shutter_tracking_(tracker_.get()) {
  RequireSound(options.Check(), "odometry: ");
}

TrackedFrame Odometry::Track(const Frame& frame,
                             const Rigid3d* cur_from_prev_guess,
                             const MotionMatrix* guess_covariance) {
  return Track(PreparedFrame(frame.Clone()), cur_from_prev_guess,
               guess_covariance);
}

TrackedFrame Odometry::Track(const PreparedFrame& frame,
                             const Rigid3d* cur_from_prev_guess,
                             const MotionMatrix* guess_covariance) {
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
  const double last_interval = interval_;
  interval_ = result.index > 0 ? frame.timestamp - timestamp_ : 0.0;
  // Across missing frames, the motion at constant velocity is longer.
  if (last_interval > 0.0 && interval_ > 0.0 && interval_ < kMaxMovedOn &&
      (interval_ > kMissingFrames * last_interval ||
       last_interval > kMissingFrames * interval_)) {
    cur_from_prev_ =
        TwistOf(cur_from_prev_, last_interval).MotionDuring(interval_);
  }
  timestamp_ = frame.timestamp;
  stamp_jitter_.Add(frame.depth_delay, interval_);
  has_shutter_ = HasShutter(frame);
  twist_.reset();
  twist_covariance_.setZero();
  aligns_depth_ = std::sqrt(timing_covariance_(5, 5)) < options_.max_time_shift;
  if (has_shutter_) {
    twist_covariance_ = MotionCovarianceOfTwist(frame.Timing(Twist()),
                                                kSigmaAngular, kSigmaLinear);
  }
  timing_covariance_ = TimingCovariance(
      frame, {{kSigmaAngular, 0.0, 0.0}, {kSigmaLinear, 0.0, 0.0}});
  {
    const StageTimer timer(&result.track_ms);
    std::optional<Prediction> prediction;
    if (cur_from_prev_guess != nullptr) {
      prediction = Predict(*cur_from_prev_guess, guess_covariance);
    }
    if (reference_ == nullptr) {
      if (TakeReference(frame, WorldFromCam(), &result)) {
        result.status = TrackingStatus::kOk;
      }
    } else if (is_lost_ && options_.on_lost == LostPolicy::kStop) {
      result.reason = "stopped after an earlier frame was lost";
    } else if (!Follow(frame, prediction, &result) &&
               !Relocalise(frame, &result)) {
      HandleLost(frame, prediction, &result);
    }
  }
  result.world_from_cam = WorldFromCam();
  result.segment = segment_;
  if (earlier_segment_.has_value() && result.status == TrackingStatus::kOk) {
    result.status = TrackingStatus::kDegraded;
    result.reason = "not yet reconnected to the previous segment";
  }
  // With ignored shutters, all of a fast camera's frames err so.
  if (options_.shutter == ShutterUse::kCamera) JudgeInflation(&result);
  last_.reset();
  if (result.status != TrackingStatus::kLost && !result.is_reference) {
    last_ = {result.index,
             segment_,
             result.world_from_cam,
             frame.WithTwist(twist_),
             {},
             {},
             twist_covariance_ + timing_covariance_};
  }
  return result;
}

void Odometry::JudgeInflation(TrackedFrame* result) {
  is_doubtful_ = attempts_.kept().is_ambiguous;
  // A failed attempt says nothing of the camera.
  if (result->status == TrackingStatus::kLost || result->reference < 0 ||
      result->source == TrackingSource::kDirect) {
    return;
  }
  const double inflation = attempts_.kept().covariance_factor;
  if (result->status == TrackingStatus::kOk &&
      inflation > kMaxInflation * usual_inflation_) {
    is_doubtful_ = true;
    result->status = TrackingStatus::kDegraded;
    result->reason =
        "neighbouring features err alike: something moves, or the shutter is "
        "not known";
  }
  const double change =
      inflation > usual_inflation_ ? kInflationUp : kInflationDown;
  usual_inflation_ = std::max(1.0, change * usual_inflation_);
}

MotionMatrix Odometry::TimingCovariance(const Frame& frame,
                                        const Twist& twist) const {
  const bool is_known =
      options_.shutter == ShutterUse::kCamera && frame.HasKnownTimes();
  const double sigma =
      is_known
          ? std::hypot(kSigmaKnownTime, kShareOfDepth * stamp_jitter_.sigma())
          : kSigmaUnknownTime;
  const double turn = twist.angular.norm();
  const double shift = twist.linear.norm() + kShiftOfTurn * turn;
  return IndependentErrors(sigma * turn, sigma * shift);
}

Odometry::Prediction Odometry::Predict(const Rigid3d& cur_from_prev,
                                       const MotionMatrix* covariance) const {
  const MotionMatrix usual = IndependentErrors(
      options_.guess_sigma_rotation, options_.guess_sigma_translation);
  return {cur_from_prev, cur_from_prev * cur_from_ref_,
          ComposedCovariance(cur_from_prev,
                             covariance != nullptr ? *covariance : usual,
                             cur_from_ref_, covariance_),
          covariance};
}

bool Odometry::Follow(const PreparedFrame& measured,
                      const std::optional<Prediction>& prediction,
                      TrackedFrame* result) {
  aligned_ = AlignToLast(measured, prediction);
  effort_ = aligned_.has_value() ? Effort::kQuick : Effort::kEverything;
  const PreparedFrame* frame = Look(measured, prediction, result);
  if (!is_lost_ && !IsTrusted(frame, *result)) {
    frame = LookFromLast(measured, prediction, frame, result);
  }
  while (frame == nullptr && effort_ != Effort::kEverything) {
    effort_ = effort_ == Effort::kQuick ? Effort::kPixels : Effort::kEverything;
    frame = Look(measured, prediction, result);
  }
  if (frame != nullptr && attempts_.kept().needs_refinement) {
    // Pixels that confirm features start from where these were searched for.
    const Rigid3d start = aligned_.value_or(Rigid3d()) * cur_from_ref_;
    attempts_.Refine(*frame, *reference_, GuessOf(start), result);
    shutter_tracking_.Update(attempts_.kept());
  }
  // A doubtful pose does not end the lost state.
  if (frame == nullptr || (is_lost_ && result->status != TrackingStatus::kOk)) {
    return false;
  }
  twist_ = frame->twist;
  if (attempts_.kept().twist.has_value()) {
    twist_covariance_ = attempts_.kept().twist_covariance;
  }
  cur_from_prev_ =
      is_lost_ ? Rigid3d()
               : last_estimate().cur_from_prev * cur_from_ref_.Inverse();
  if (!is_lost_ && interval_ > 0.0) {
    timing_covariance_ =
        TimingCovariance(measured, TwistOf(cur_from_prev_, interval_));
  }
  TakeMotion(result);
  if (has_shutter_) shutter_tracking_.Accept();
  if (earlier_segment_.has_value()) ReturnToEarlierSegment(*frame, result);
  Accept(*frame, result);
  return true;
}

std::optional<Rigid3d> Odometry::AlignToLast(
    const PreparedFrame& frame, const std::optional<Prediction>& prediction) {
  if (is_lost_ || is_doubtful_) return std::nullopt;
  const Keyframe* last = nullptr;
  if (last_.has_value()) {
    last = &*last_;
  } else if (reference_->id == num_frames_ - 2) {
    last = reference_;
  }
  if (last == nullptr) return std::nullopt;
  PreparedFrame seen = frame;
  seen.twist = last->frame.twist;
  return tracker_->AlignCoarsely(
      last->frame, seen,
      prediction.has_value() ? prediction->cur_from_prev : cur_from_prev_);
}

// Tracks from where coarse images say that the camera is. Where they do not say
// it, from the last pose, and only then from a constant velocity, which can lock
// onto its own false motion.
const PreparedFrame* Odometry::Look(const PreparedFrame& measured,
                                    const std::optional<Prediction>& prediction,
                                    TrackedFrame* result) {
  Rigid3d first = cur_from_ref_;
  Rigid3d second = cur_from_prev_ * cur_from_ref_;
  std::optional<Rigid3d> aligned;
  if (aligned_.has_value()) aligned = *aligned_ * cur_from_ref_;
  const auto track = [&](const PreparedFrame& frame,
                         const VelocityPrior* velocity) {
    const auto from = [&](const Rigid3d& cur_from_ref) {
      TrackingGuess guess = GuessOf(cur_from_ref);
      guess.velocity = velocity;
      guess.leaves_refinement = effort_ != Effort::kEverything;
      return guess;
    };
    if (prediction.has_value()) {
      TrackingGuess guess = from(prediction->cur_from_ref);
      if (prediction->given != nullptr) {
        guess.covariance = &prediction->covariance;
      }
      guess.search_at = aligned;
      if (attempts_.Try(frame, *reference_, guess, result)) return true;
    }
    TrackingGuess start = from(first);
    if (effort_ != Effort::kEverything) {
      start.search_at = aligned;
      start.is_tentative = effort_ == Effort::kQuick;
      return attempts_.Try(frame, *reference_, start, result) &&
             !attempts_.kept().is_partial;
    }
    const TrackingGuess other = from(second);
    return attempts_.TryInTurn(
        frame, *reference_, start, other,
        [&](Rigid3d* cur_from_ref) {
          const StageTimer timer(&result->relocalise_ms);
          return relocaliser_.FindIn(frame, reference_, cur_from_ref);
        },
        result);
  };
  if (!has_shutter_) {
    // A frame without a shutter among frames with one does not determine a
    // velocity, and the known velocity is older than this frame.
    shutter_tracking_.Forget();
    return track(measured, nullptr) ? &measured : nullptr;
  }
  const auto track_again = [&](const PreparedFrame& frame,
                               const VelocityPrior& velocity,
                               const Rigid3d& cur_from_ref) {
    TrackingGuess guess = GuessOf(cur_from_ref);
    guess.velocity = &velocity;
    guess.leaves_refinement = true;
    return attempts_.TryAgain(frame, *reference_, guess, result);
  };
  std::optional<Twist> twist;
  if (prediction.has_value() && interval_ > 0.0) {
    twist = TwistOf(prediction->cur_from_prev, interval_);
  }
  std::optional<Rigid3d> prev_from_ref;
  if (!is_lost_) prev_from_ref = cur_from_ref_;
  return shutter_tracking_.Follow(measured, interval_, prev_from_ref, twist,
                                  reference_, attempts_.kept(), track,
                                  track_again);
}

void Odometry::TakeMotion(TrackedFrame* result) {
  const MotionEstimate& estimate = last_estimate();
  cur_from_ref_ = estimate.cur_from_prev;
  covariance_ = estimate.covariance;
  if (!attempts_.kept().twist.has_value()) covariance_ += twist_covariance_;
  covariance_ += timing_covariance_ + reference_->timing_covariance;
  result->cur_from_reference = cur_from_ref_;
  if (!HasMotion(estimate)) return;
  result->edges.insert(result->edges.begin(), {reference_->id, result->index,
                                               cur_from_ref_, covariance_});
}

void Odometry::Accept(const PreparedFrame& frame, TrackedFrame* result) {
  is_lost_ = false;
  is_unconnected_ = false;
  tracker_->OnAccepted(reference_->reference.get(), attempts_.mutable_kept());
  if (!NeedsNewReference()) return;
  const Rigid3d world_from_cam = WorldFromCam();
  OdometryKeyframe* const earlier =
      keyframes_.FindNearest(world_from_cam, segment_, kMinReturnShare,
                             kMaxReturnFlow * options_.max_flow_px, reference_);
  if (earlier != nullptr &&
      attempts_.TryFallback(
          frame, *earlier,
          GuessOf(world_from_cam.Inverse() * earlier->world_from_cam), result,
          [&] { return !NeedsNewReference(); })) {
    reference_ = earlier;
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
  const bool was_tracked = reference_ != nullptr && !is_lost;
  std::string why_not;
  MotionMatrix covariance = timing_covariance_;
  if (frame.twist.has_value()) covariance += twist_covariance_;
  OdometryKeyframe* const added = AddKeyframe(
      {result->index, segment_, world_from_cam, frame, {}, {}, covariance},
      was_tracked ? reference_->reference.get() : nullptr, nullptr, &why_not);
  if (added == nullptr) {
    if (is_lost) result->reason = why_not;
    return false;
  }
  reference_ = added;
  if (has_shutter_) shutter_tracking_.AddReference(*added);
  cur_from_ref_ = Rigid3d();
  covariance_.setZero();
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
    added.segment = segment_;
    added.frame = inserted.Unpacked();
    added.images = {};
    return AddKeyframe(std::move(added), nullptr, reference_, &why_not) !=
           nullptr;
  }
  if (keyframe == reference_) return true;
  keyframe->world_from_cam = inserted.world_from_cam;
  keyframe->segment = segment_;
  keyframes_.Renew(keyframe);
  return true;
}

Rigid3d Odometry::WorldFromCam() const {
  if (reference_ == nullptr) return Rigid3d();
  return reference_->world_from_cam * cur_from_ref_.Inverse();
}

}  // namespace rgbd_pose
