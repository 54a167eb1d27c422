#include "frontend/tracking/odometry.h"

#include <cmath>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/stage_timer.h"

namespace rgbd_pose {
namespace {

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

// Whether a turn from one frame to the next lets images show the same (at 30
// frames/s up to 170 degrees/s), and starts or stops slowly enough to bend them
// by less than a pixel. `acceleration`: see ShutterTracking.
bool IsSlow(const CameraTurn& turn, const MotionMatrix& acceleration) {
  constexpr double kLargestTurn = 0.1;    // rad
  constexpr double kLargestBend = 0.002;  // rad
  return turn.cur_from_prev.angularDistance(Eigen::Quaterniond::Identity()) <=
             kLargestTurn &&
         acceleration(0, 0) <= kLargestBend * kLargestBend;
}

// The pose follows the guess while tracking is lost.
void RequireFinite(const Rigid3d* guess, const MotionMatrix* covariance) {
  if (guess == nullptr) return;
  if (guess->IsFinite() && (covariance == nullptr || covariance->allFinite())) {
    return;
  }
  throw InputError(
      "odometry: the motion guess or its covariance is not finite; leave it "
      "out for this frame");
}

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
  RequireSize(frame);
  RequireFinite(cur_from_prev_guess, guess_covariance);
  TrackedFrame result;
  result.index = num_frames_++;
  result.timestamp = frame.timestamp;
  is_repeated_ = repeated_.IsRepeated(measured);
  // Then, unless it is lost, tracking goes on from the frame before; a guess
  // would be of another interval.
  std::optional<State> before;
  if (is_repeated_ && cur_from_prev_guess == nullptr) before = state_;
  Begin(frame);
  {
    const StageTimer timer(&result.track_ms);
    if (!state_.carried.empty()) {
      frame.depth = state_.carried.WithoutRegion(frame.depth);
    }
    std::optional<Prediction> prediction;
    if (cur_from_prev_guess != nullptr) {
      prediction = Predict(*cur_from_prev_guess, guess_covariance);
    }
    FindPose(frame, prediction, &result);
  }
  result.world_from_cam = WorldFromCam();
  result.segment = state_.segment;
  Judge(&result);
  Learn(frame, result);
  KeepLast(frame, &result);
  if (before.has_value() && result.status != TrackingStatus::kLost) {
    state_ = *std::move(before);
  }
  return result;
}

void Odometry::RequireSize(const Frame& frame) const {
  const Camera& camera = tracker_->images().camera;
  const cv::Size size(camera.width, camera.height);
  if (frame.gray.size() != size || frame.depth.size() != size) {
    throw InputError(
        Format("odometry: grey and depth image must have the size of the "
               "camera, %d x %d",
               size.width, size.height));
  }
}

void Odometry::Begin(const Frame& frame) {
  UpdateInterval(frame.timestamp);
  state_.stamp_jitter.Add(frame.depth_delay, state_.interval);
  state_.has_shutter = HasShutter(frame);
  state_.twist.reset();
  state_.twist_covariance.setZero();
  // Accelerations count, too: without them, four times as many frames of quick
  // pans were wrong.
  state_.aligns_depth =
      std::sqrt(state_.timing_covariance(5, 5)) < options_.max_time_shift;
  if (state_.has_shutter) {
    state_.twist_covariance = MotionCovarianceOfTwist(
        frame.Timing(Twist()), kSigmaAngular, kSigmaLinear);
  }
  state_.timing_covariance = TimingCovariance(
      frame, {{kSigmaAngular, 0.0, 0.0}, {kSigmaLinear, 0.0, 0.0}});
  state_.turn.reset();
  if (inertial_.has_value() && state_.interval > 0.0) {
    state_.turn =
        inertial_->Turn(frame.timestamp - state_.interval, frame.timestamp);
  }
}

void Odometry::UpdateInterval(double timestamp) {
  const double last_interval = state_.interval;
  const bool is_first = num_frames_ == 1;
  state_.interval = is_first ? 0.0 : timestamp - state_.timestamp;
  state_.timestamp = timestamp;
  // Across missing frames, the motion at constant velocity is longer.
  if (last_interval > 0.0 && state_.interval > 0.0 &&
      state_.interval < kMaxMovedOn &&
      (state_.interval > kMissingFrames * last_interval ||
       last_interval > kMissingFrames * state_.interval)) {
    state_.cur_from_prev = TwistOf(state_.cur_from_prev, last_interval)
                               .MotionDuring(state_.interval);
  }
}

void Odometry::FindPose(const PreparedFrame& frame,
                        const std::optional<Prediction>& prediction,
                        TrackedFrame* result) {
  if (state_.reference == nullptr) {
    if (TakeReference(frame, WorldFromCam(), result)) {
      result->status = TrackingStatus::kOk;
    }
  } else if (state_.is_lost && options_.on_lost == LostPolicy::kStop) {
    result->reason = "stopped after an earlier frame was lost";
  } else if (!Follow(frame, prediction, result) && !Relocalise(frame, result) &&
             !GoOnBlindly(frame, result)) {
    HandleLost(frame, prediction, result);
  }
}

void Odometry::Judge(TrackedFrame* result) {
  if (state_.earlier_segment.has_value() &&
      result->status == TrackingStatus::kOk) {
    result->status = TrackingStatus::kDegraded;
    result->reason = "not yet reconnected to the previous segment";
  }
  // With ignored shutters, all of a fast camera's frames err so.
  if (options_.shutter == ShutterUse::kCamera) JudgeInflation(result);
  if (is_repeated_ &&
      (result->status == TrackingStatus::kOk || result->reason.empty())) {
    result->reason = "an image of it is that of the frame before";
    if (result->status == TrackingStatus::kOk) {
      result->status = TrackingStatus::kDegraded;
    }
  }
}

void Odometry::Learn(const Frame& frame, const TrackedFrame& result) {
  const bool is_ok = result.status == TrackingStatus::kOk;
  const OdometryKeyframe* const reference =
      is_ok ? FindKeyframe(result.reference) : nullptr;
  if (reference != nullptr) {
    state_.carried.Learn(reference->frame, frame, tracker_->images().camera,
                         result.cur_from_reference);
  }
  if (inertial_.has_value()) inertial_->Learn(result);
  if (is_ok) {
    state_.seen = {state_.reference->id, state_.cur_from_ref,
                   state_.covariance};
  }
}

void Odometry::KeepLast(const PreparedFrame& frame, TrackedFrame* result) {
  state_.last.reset();
  // What the inertial sensor alone has placed may show another place, from
  // where the next frame is tracked once the camera turns slowly enough.
  if (result->source == TrackingSource::kInertial &&
      !IsSlow(state_.turn.value_or(CameraTurn()),
              state_.shutter_tracking.acceleration_covariance())) {
    result->reason = "too quick a turn for images: inertial sensor only";
    return;
  }
  if (result->status == TrackingStatus::kLost || result->is_reference ||
      is_repeated_) {
    return;
  }
  state_.last = {result->index,
                 state_.segment,
                 result->world_from_cam,
                 frame.WithTwist(state_.twist),
                 {},
                 {},
                 state_.twist_covariance + state_.timing_covariance};
}

void Odometry::JudgeInflation(TrackedFrame* result) {
  state_.is_doubtful = attempts_.kept().is_ambiguous;
  // A failed attempt says nothing of the camera.
  if (result->status == TrackingStatus::kLost || result->reference < 0 ||
      result->source == TrackingSource::kDirect ||
      result->source == TrackingSource::kInertial) {
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
Rigid3d Odometry::WorldFromCam() const {
  if (state_.reference == nullptr) return Rigid3d();
  return state_.reference->world_from_cam * state_.cur_from_ref.Inverse();
}

}  // namespace rgbd_pose
