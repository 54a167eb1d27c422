#include "frontend/odometry.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace rgbd_pose {
namespace {

using Clock = std::chrono::steady_clock;

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start)
      .count();
}

}  // namespace

const char* ToString(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::kOk:
      return "ok";
    case TrackingStatus::kDegraded:
      return "degraded";
    case TrackingStatus::kLost:
      return "lost";
  }
  return "unknown";
}

std::string OdometryOptions::Check() const {
  if (min_inliers < 3) return "min_inliers must be at least 3";
  if (min_inliers_ok < min_inliers) {
    return "min_inliers_ok must not be below min_inliers";
  }
  if (!(max_flow_px > 0.0)) return "max_flow_px must be positive";
  if (!(prior_sigma_rotation > 0.0) || !(prior_sigma_translation > 0.0)) {
    return "the prior's standard deviations must be positive";
  }
  return "";
}

Odometry::Odometry(const OdometryOptions& options, const Camera& camera,
                   std::unique_ptr<Frontend> frontend, Estimator estimator)
    : options_(options),
      frontend_(std::move(frontend)),
      estimator_(std::move(estimator)),
      found_{Correspondences(camera), {}} {}

TrackedFrame Odometry::Track(const Frame& frame) {
  const Clock::time_point start = Clock::now();
  TrackedFrame result;
  result.index = frame.index;
  result.timestamp = frame.timestamp;
  if (reference_ == nullptr) {
    TakeReference(frame, &result);
    result.status = TrackingStatus::kOk;
    const size_t features = reference_->observations.size();
    if (features < static_cast<size_t>(options_.min_inliers)) {
      result.status = TrackingStatus::kLost;
      result.reason = "only " + std::to_string(features) +
                      " features with depth to start from";
      reference_ = nullptr;
    }
    result.world_from_cam = world_from_ref_ * cur_from_ref_.Inverse();
    result.track_ms = MillisecondsSince(start);
    return result;
  }
  // First from the last pose. A constant velocity is only a second try: as the
  // first it can lock onto its own false motion.
  const Rigid3d last = cur_from_ref_;
  const Rigid3d predicted = cur_from_prev_ * last;
  const bool tracked =
      TryGuess(frame, options_.predict_velocity ? predicted : last, &result) ||
      TryGuess(frame, options_.predict_velocity ? last : predicted, &result);
  if (tracked) {
    cur_from_prev_ = cur_from_ref_ * last.Inverse();
  } else {
    result.status = TrackingStatus::kLost;
    cur_from_prev_ = Rigid3d();
  }
  result.world_from_cam = world_from_ref_ * cur_from_ref_.Inverse();
  if (!tracked || NeedsNewReference(result.inliers)) {
    TakeReference(frame, &result);
  }
  result.track_ms = MillisecondsSince(start);
  return result;
}

bool Odometry::TryGuess(const Frame& frame, const Rigid3d& cur_from_ref_guess,
                        TrackedFrame* result) {
  const Clock::time_point start = Clock::now();
  frontend_->Match(*reference_, frame, cur_from_ref_guess, &found_);
  result->frontend_ms += MillisecondsSince(start);
  Estimate(cur_from_ref_guess);
  result->solve_ms += estimate_.solve_ms;
  result->matches = static_cast<int>(found_.matches.size());
  result->inliers = estimate_.num_inliers;
  result->iterations += estimate_.iterations;
  result->sigma = estimate_.sigma;
  result->reason = estimate_.reason;
  const bool usable = estimate_.status == EstimateStatus::kOk ||
                      estimate_.status == EstimateStatus::kNotConverged;
  if (!usable) return false;
  if (estimate_.num_inliers < options_.min_inliers) {
    result->reason =
        "only " + std::to_string(estimate_.num_inliers) + " inliers";
    return false;
  }
  cur_from_ref_ = estimate_.cur_from_prev;
  const double share =
      static_cast<double>(estimate_.num_inliers) / estimate_.num_used;
  result->status = TrackingStatus::kOk;
  if (estimate_.num_inliers < options_.min_inliers_ok) {
    result->status = TrackingStatus::kDegraded;
    result->reason =
        "only " + std::to_string(estimate_.num_inliers) + " inliers";
  } else if (share < options_.min_inlier_share_ok) {
    result->status = TrackingStatus::kDegraded;
    result->reason = "only " + std::to_string(estimate_.num_inliers) + " of " +
                     std::to_string(estimate_.num_used) + " matches agree";
  } else if (!estimate_.ok()) {
    result->status = TrackingStatus::kDegraded;
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

void Odometry::TakeReference(const Frame& frame, TrackedFrame* result) {
  const Clock::time_point start = Clock::now();
  world_from_ref_ = world_from_ref_ * cur_from_ref_.Inverse();
  cur_from_ref_ = Rigid3d();
  reference_ = frontend_->Detect(frame);
  result->is_reference = true;
  result->frontend_ms += MillisecondsSince(start);
}

bool Odometry::NeedsNewReference(int inliers) const {
  return inliers <
             options_.min_reference_share * reference_->observations.size() ||
         inliers < options_.min_inliers_ok ||
         MeanInlierFlowPx() > options_.max_flow_px;
}

double Odometry::MeanInlierFlowPx() const {
  double sum = 0.0;
  int count = 0;
  for (size_t i = 0; i < found_.matches.size(); ++i) {
    if (!estimate_.is_inlier[i]) continue;
    const Observation prev = found_.matches.prev()[i];
    const Observation cur = found_.matches.cur()[i];
    sum += std::hypot(cur.u - prev.u, cur.v - prev.v);
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace rgbd_pose
