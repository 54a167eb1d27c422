#include "frontend/tracking/odometry.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace rgbd_pose {
namespace {

using Clock = std::chrono::steady_clock;

// Adds the time it lives to a sum.
class StageTimer {
 public:
  explicit StageTimer(double* sum_ms) : sum_ms_(sum_ms) {}
  ~StageTimer() {
    *sum_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start_)
                    .count();
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  double* sum_ms_;
  Clock::time_point start_ = Clock::now();
};

// An earlier reference is taken up again if so much of it is in view, near to
// where it was (as a share of max_flow_px): otherwise it would have to be left
// again soon.
constexpr double kMinReturnShare = 0.7;
constexpr double kMaxReturnFlow = 0.5;

std::string OnlyInliers(int inliers) {
  return "only " + std::to_string(inliers) + " inliers";
}

}  // namespace

std::string OdometryOptions::Check() const {
  if (min_inliers < 3) return "min_inliers must be at least 3";
  if (min_inliers_ok < min_inliers) {
    return "min_inliers_ok must not be below min_inliers";
  }
  if (!(max_flow_px > 0.0)) return "max_flow_px must be positive";
  if (!(prior_sigma_rotation > 0.0) || !(prior_sigma_translation > 0.0)) {
    return "the prior's standard deviations must be positive";
  }
  if (!(new_segment_after >= 0.0)) {
    return "new_segment_after must not be negative";
  }
  return "";
}

Odometry::Odometry(const OdometryOptions& options, const Camera& camera,
                   std::unique_ptr<Frontend> frontend, Estimator estimator)
    : options_(options),
      frontend_(std::move(frontend)),
      estimator_(std::move(estimator)),
      keyframes_(camera),
      relocaliser_(camera),
      found_{Correspondences(camera), {}},
      doubted_(found_),
      other_found_(found_),
      other_doubted_(found_) {}

TrackedFrame Odometry::Track(const Frame& frame,
                             const Rigid3d* cur_from_prev_guess) {
  double prepare_ms = 0.0;
  std::unique_ptr<const PreparedFrame> prepared;
  {
    const StageTimer timer(&prepare_ms);
    prepared = Prepare(frame);
  }
  TrackedFrame result = Track(*prepared, cur_from_prev_guess);
  result.track_ms += prepare_ms;
  return result;
}

TrackedFrame Odometry::Track(const PreparedFrame& frame,
                             const Rigid3d* cur_from_prev_guess) {
  TrackedFrame result;
  result.index = frame.index;
  result.timestamp = frame.timestamp;
  {
    const StageTimer timer(&result.track_ms);
    if (reference_ == nullptr) {
      Start(frame, &result);
    } else if (is_lost_ && options_.on_lost == LostPolicy::kStop) {
      result.reason = "stopped after an earlier frame was lost";
    } else if (!Follow(frame, cur_from_prev_guess, &result) &&
               !Relocalise(frame, &result)) {
      Lose(frame, &result);
    }
  }
  result.world_from_cam = WorldFromCam();
  result.segment = segment_;
  return result;
}

void Odometry::Start(const PreparedFrame& frame, TrackedFrame* result) {
  if (!TakeReference(frame, WorldFromCam(), result)) return;
  result->status = TrackingStatus::kOk;
  tracked_at_ = frame.timestamp;
}

// First from the last pose. A constant velocity is only a second try: as the
// first it can lock onto its own false motion.
bool Odometry::Follow(const PreparedFrame& frame,
                      const Rigid3d* cur_from_prev_guess,
                      TrackedFrame* result) {
  const Rigid3d last = cur_from_ref_;
  const Rigid3d predicted = cur_from_prev_ * last;
  const Rigid3d first = options_.predict_velocity ? predicted : last;
  const Rigid3d second = options_.predict_velocity ? last : predicted;
  const bool tracked =
      (cur_from_prev_guess != nullptr &&
       Try(frame, *reference_, *cur_from_prev_guess * last, result)) ||
      Try(frame, *reference_, first, result) ||
      Try(frame, *reference_, second, result);
  // A doubtful pose is no way back from being lost.
  if (!tracked || (is_lost_ && result->status != TrackingStatus::kOk)) {
    return false;
  }
  cur_from_ref_ = estimate_.cur_from_prev;
  cur_from_prev_ = is_lost_ ? Rigid3d() : cur_from_ref_ * last.Inverse();
  Accept(frame, result);
  return true;
}

bool Odometry::Relocalise(const PreparedFrame& frame, TrackedFrame* result) {
  std::optional<Relocalisation> place;
  {
    const StageTimer timer(&result->relocalise_ms);
    place = relocaliser_.Find(frame);
  }
  if (!place.has_value()) return false;
  Keyframe* keyframe = keyframes_.Find(place->keyframe_id);
  if (keyframe == nullptr ||
      !Try(frame, *keyframe, place->cur_from_keyframe, result) ||
      result->status != TrackingStatus::kOk) {
    return false;
  }
  reference_ = keyframe;
  segment_ = keyframe->segment;
  cur_from_ref_ = estimate_.cur_from_prev;
  cur_from_prev_ = Rigid3d();
  result->relocalised = true;
  Accept(frame, result);
  return true;
}

void Odometry::Lose(const PreparedFrame& frame, TrackedFrame* result) {
  is_lost_ = true;
  result->status = TrackingStatus::kLost;
  if (options_.on_lost == LostPolicy::kPredict) {
    cur_from_ref_ = cur_from_prev_ * cur_from_ref_;
    return;
  }
  cur_from_prev_ = Rigid3d();
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
  result->reason = "a new segment: the motion since it was lost is unknown";
}

bool Odometry::Try(const PreparedFrame& frame, const Keyframe& reference,
                   const Rigid3d& cur_from_ref_guess, TrackedFrame* result) {
  {
    const StageTimer timer(&result->match_ms);
    frontend_->Match(*reference.features, frame, cur_from_ref_guess, &found_);
    reference.trust.Split(&found_, &doubted_);
  }
  Estimate(cur_from_ref_guess);
  const int inliers = estimate_.num_inliers;
  result->reference = reference.index;
  result->solve_ms += estimate_.solve_ms;
  result->matches = static_cast<int>(found_.matches.size());
  result->inliers = inliers;
  result->iterations += estimate_.iterations;
  result->sigma = estimate_.sigma;
  result->status = TrackingStatus::kLost;
  result->reason = estimate_.reason;
  const bool usable = estimate_.status == EstimateStatus::kOk ||
                      estimate_.status == EstimateStatus::kNotConverged;
  if (!usable) return false;
  if (inliers < options_.min_inliers) {
    result->reason = OnlyInliers(inliers);
    return false;
  }
  result->status =
      estimate_.ok() ? TrackingStatus::kOk : TrackingStatus::kDegraded;
  if (inliers < options_.min_inliers_ok) {
    result->status = TrackingStatus::kDegraded;
    result->reason = OnlyInliers(inliers);
  } else if (inliers < options_.min_inlier_share_ok * estimate_.num_used) {
    result->status = TrackingStatus::kDegraded;
    result->reason = "only " + std::to_string(inliers) + " of " +
                     std::to_string(estimate_.num_used) + " matches agree";
  }
  return true;
}

void Odometry::Estimate(const Rigid3d& cur_from_ref_guess) {
  Rigid3d guess = cur_from_ref_guess;
  if (options_.initial_guess != nullptr) {
    guess = options_.initial_guess->find(found_.matches).value_or(guess);
  }
  MotionPrior prior;
  prior.cur_from_prev = cur_from_ref_guess;
  const double turn = options_.prior_sigma_rotation;
  const double shift = options_.prior_sigma_translation;
  prior.covariance.diagonal() << turn * turn, turn * turn, turn * turn,
      shift * shift, shift * shift, shift * shift;
  estimator_.Estimate(found_.matches, guess, &prior, &estimate_);
}

void Odometry::Accept(const PreparedFrame& frame, TrackedFrame* result) {
  is_lost_ = false;
  tracked_at_ = frame.timestamp;
  reference_->trust.Learn(doubted_, cur_from_ref_);
  if (NeedsNewReference()) ChangeReference(frame, result);
}

bool Odometry::NeedsNewReference() const {
  const int inliers = estimate_.num_inliers;
  return inliers <
             options_.min_reference_share * reference_->trust.num_trusted() ||
         inliers < options_.min_inliers_ok ||
         MeanInlierFlowPx() > options_.max_flow_px;
}

void Odometry::ChangeReference(const PreparedFrame& frame,
                               TrackedFrame* result) {
  const Rigid3d world_from_cam = WorldFromCam();
  Keyframe* const earlier =
      keyframes_.FindNearest(world_from_cam, segment_, kMinReturnShare,
                             kMaxReturnFlow * options_.max_flow_px, reference_);
  if (earlier == nullptr ||
      !ReturnTo(frame, earlier,
                world_from_cam.Inverse() * earlier->world_from_cam, result)) {
    TakeReference(frame, world_from_cam, result);
  }
}

bool Odometry::ReturnTo(const PreparedFrame& frame, Keyframe* earlier,
                        const Rigid3d& cur_from_earlier_guess,
                        TrackedFrame* result) {
  TrackedFrame attempt = *result;
  SwapAttempts();
  std::swap(reference_, earlier);
  if (Try(frame, *reference_, cur_from_earlier_guess, &attempt) &&
      attempt.status == TrackingStatus::kOk && !NeedsNewReference()) {
    cur_from_ref_ = estimate_.cur_from_prev;
    *result = attempt;
    return true;
  }
  SwapAttempts();
  std::swap(reference_, earlier);
  result->match_ms = attempt.match_ms;
  result->solve_ms = attempt.solve_ms;
  return false;
}

void Odometry::SwapAttempts() {
  std::swap(found_, other_found_);
  std::swap(doubted_, other_doubted_);
  std::swap(estimate_, other_estimate_);
}

bool Odometry::TakeReference(const PreparedFrame& frame,
                             const Rigid3d& world_from_cam,
                             TrackedFrame* result) {
  const StageTimer timer(&result->reference_ms);
  std::unique_ptr<FeatureSet> features = frontend_->Detect(frame);
  // Trust is passed on from reference to reference as long as they are tracked;
  // where hardly any feature would have it the doubt itself is in doubt.
  const bool was_tracked =
      reference_ != nullptr && result->status != TrackingStatus::kLost;
  const FeatureTrust trust =
      was_tracked ? FeatureTrust(*reference_->features, found_, doubted_,
                                 estimate_, frontend_->finds_all_in_view(),
                                 *features, 2 * options_.min_inliers_ok)
                  : FeatureTrust(features->observations.size());
  const size_t count = features->observations.size();
  if (count < static_cast<size_t>(options_.min_inliers)) {
    if (result->status == TrackingStatus::kLost) {
      result->reason = "only " + std::to_string(count) +
                       " features with depth to start from";
    }
    return false;
  }
  reference_ = keyframes_.Add(
      {frame.index, segment_, world_from_cam, std::move(features), trust});
  relocaliser_.Add(frame, frame.index);
  cur_from_ref_ = Rigid3d();
  result->is_reference = true;
  return true;
}

double Odometry::MeanInlierFlowPx() const {
  double sum = 0.0;
  int count = 0;
  for (size_t i = 0; i < found_.matches.size(); ++i) {
    if (!estimate_.is_inlier[i]) continue;
    const Observation& prev = found_.matches[i].prev;
    const Observation& cur = found_.matches[i].cur;
    sum += std::hypot(cur.u - prev.u, cur.v - prev.v);
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

Rigid3d Odometry::WorldFromCam() const {
  if (reference_ == nullptr) return Rigid3d();
  return reference_->world_from_cam * cur_from_ref_.Inverse();
}

}  // namespace rgbd_pose
