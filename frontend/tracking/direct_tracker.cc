#include "frontend/tracking/direct_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/small_matrix.h"
#include "frontend/frame/image_pyramid.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// Level at which views are compared: noise and errors of 1 or 2 px are small.
constexpr size_t kLikenessLevel = 3;
// A reference needs at least this many samples (of 768).
constexpr size_t kMinSamples = 40;

// A frame is lost with fewer pixels, degraded if less of its reference is seen.
constexpr int kMinPixels = 200;
constexpr double kMinSeenShareOk = 0.3;

// It is degraded if any direction has a larger standard deviation.
constexpr double kMaxSigmaRotation = 0.005;    // rad
constexpr double kMaxSigmaTranslation = 0.01;  // m

// With pixels alone, as nothing led the way, it is degraded if its residuals
// spread wider, in sigmas. Right motions have 0.8, with blur 1.9; wrong 2 to 5.
constexpr double kMaxSigmaOk = 2.0;

// Beyond this (see CovarianceInflation), neighbouring features err alike.
constexpr double kErrAlike = 2.0;

// Returns the largest standard deviation in any direction of a covariance.
double LargestSigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, EigenOf(covariance).eigenvalues()[2]));
}

}  // namespace

DirectTracker::DirectTracker(const FrontendOptions& images,
                             DirectEstimators estimators,
                             const TrackerOptions& options)
    : images_(images), estimators_(std::move(estimators)), options_(options) {
  RequireSound(images.Check(), "tracker: ");
  RequireSound(options.Check(), "tracker: ");
}

void DirectTracker::Prepare(const PreparedFrame& frame) const {
  frame.Derived<SmoothPyramid>();
}

std::unique_ptr<Reference> DirectTracker::MakeReference(
    const PreparedFrame& frame, const Reference* /*last*/,
    const TrackingResult* /*tracked*/, std::string* why_not) {
  auto reference = std::make_unique<Reference>();
  reference->pixels =
      std::make_unique<ReferencePixels>(frame, images_, ++last_id_);
  if (reference->pixels->samples.size() < kMinSamples) {
    *why_not = "too few pixels with depth";
    return nullptr;
  }
  return reference;
}

void DirectTracker::MoveReference(const PreparedFrame& frame,
                                  const Rigid3d& reference_from_stamp,
                                  Reference* reference) const {
  FrameView& view = reference->pixels->view;
  view.timing = frame.Timing();
  view.reference_from_stamp = reference_from_stamp;
  view.id = ++last_id_;  // costs select the points again
}

std::optional<Rigid3d> DirectTracker::AlignCoarsely(
    const PreparedFrame& prev, const PreparedFrame& cur,
    const Rigid3d& cur_from_prev_start, bool /*has_shutter*/) {
  if (!estimators_.coarse.has_value()) return std::nullopt;
  FrameView view = ViewFrame(prev, prev.Derived<SmoothPyramid>().levels,
                             images_.camera, images_.depth.noise);
  Estimate(view, cur, cur_from_prev_start,
           PriorOf(options_, cur_from_prev_start), nullptr,
           &*estimators_.coarse, &start_);
  // Where one of the images is black, all points agree, with any motion.
  constexpr double kLessThanPrior = 0.5;
  const double most = kLessThanPrior * options_.prior_sigma_rotation;
  const double variance = start_.covariance.diagonal().head<3>().minCoeff();
  if (HasMotion(start_) && !(variance < most * most)) return std::nullopt;
  if (HasMotion(start_)) return start_.cur_from_prev;
  // Blur lets fewer points agree, but two frames in a row are never far apart.
  constexpr double kMinShare = 0.5;
  if (start_.status != EstimateStatus::kInconsistent ||
      start_.num_inliers < kMinShare * start_.num_used) {
    return std::nullopt;
  }
  return start_.cur_from_prev;
}

void DirectTracker::Track(const Reference& reference,
                          const PreparedFrame& frame,
                          const TrackingGuess& guess, TrackingResult* tracked) {
  tracked->Begin(TrackingSource::kDirect);
  MotionEstimate* const estimate = &tracked->estimate;
  Estimate(reference.pixels->view, frame,
           guess.search_at.value_or(guess.cur_from_ref),
           PriorOf(options_, guess), nullptr, &estimators_.leading, estimate);
  if (estimate->num_used > 0) {
    Estimate(reference.pixels->view, frame, Rigid3d(estimate->cur_from_prev),
             PriorOf(options_, guess), nullptr, &estimators_.refining,
             estimate);
  }
  if (guess.velocity != nullptr) FindTwist(reference, frame, guess, tracked);
  Judge(reference, frame, /*is_alone=*/true, tracked);
}

void DirectTracker::TrackAgain(const Reference& reference,
                               const PreparedFrame& frame,
                               const TrackingGuess& guess,
                               TrackingResult* tracked) {
  tracked->Begin(TrackingSource::kDirect);
  Estimate(reference.pixels->view, frame, guess.cur_from_ref,
           PriorOf(options_, guess), nullptr, &estimators_.refining,
           &tracked->estimate);
  if (guess.velocity != nullptr) FindTwist(reference, frame, guess, tracked);
  Judge(reference, frame, /*is_alone=*/true, tracked);
}

void DirectTracker::RefineWithMatches(const Reference& reference,
                                      const PreparedFrame& frame,
                                      const TrackingResult& by_features,
                                      TrackingResult* tracked) {
  tracked->Begin(TrackingSource::kDirect);
  Estimate(reference.pixels->view, frame, by_features.estimate.cur_from_prev,
           by_features.prior, &by_features, &estimators_.refining,
           &tracked->estimate);
  Judge(reference, frame, /*is_alone=*/false, tracked);
}

void DirectTracker::FindTwist(const Reference& reference,
                              const PreparedFrame& frame,
                              const TrackingGuess& guess,
                              TrackingResult* tracked) {
  constexpr int kMaxRounds = 2;
  constexpr double kSmallFlowPx = 0.2;
  MotionEstimate* const estimate = &tracked->estimate;
  PreparedFrame seen = frame.WithTwist(frame.twist.value_or(Twist()));
  for (int round = 0; round < kMaxRounds && estimate->ok(); ++round) {
    const Twist twist =
        guess.velocity->Mean(estimate->cur_from_prev, *seen.twist);
    if (LargestFlow(images_.camera, seen.Timing(), twist - *seen.twist) <
        kSmallFlowPx) {
      break;
    }
    seen.twist = twist;
    Estimate(reference.pixels->view, seen, Rigid3d(estimate->cur_from_prev),
             PriorOf(options_, guess), nullptr, &estimators_.refining,
             estimate);
  }
  tracked->velocity = ExpectedTwist(seen.Timing(), *guess.velocity);
  estimate->covariance += tracked->velocity->motion_covariance;
}

Rigid3d DirectTracker::FindStart(const Reference& reference,
                                 const PreparedFrame& frame,
                                 const TrackingGuess& guess) {
  if (!estimators_.coarse.has_value()) return guess.cur_from_ref;
  Estimate(reference.pixels->view, frame, guess.cur_from_ref,
           PriorOf(options_, guess), nullptr, &*estimators_.coarse, &start_);
  return HasMotion(start_) ? start_.cur_from_prev : guess.cur_from_ref;
}

void DirectTracker::Estimate(const FrameView& prev, const PreparedFrame& frame,
                             const Rigid3d& start, const MotionPrior& prior,
                             const TrackingResult* by_features,
                             Estimator* estimator,
                             MotionEstimate* estimate) const {
  FrameView view = ViewFrame(frame, frame.Derived<SmoothPyramid>().levels,
                             images_.camera, images_.depth.noise);
  FramePair pair;
  if (by_features != nullptr) {
    pair.matches = &by_features->matches.matches;
    view.moving = &by_features->moving;
    // Few features do not show whether they do.
    const bool are_alike = by_features->covariance_factor > kErrAlike ||
                           by_features->needs_new_keyframe;
    // Without a depth image, only gray levels refine the motion.
    if (are_alike && !by_features->aligns_depth) view.depth = {};
  }
  pair.prior = &prior;
  pair.prev = &prev;
  pair.cur = &view;
  // Near the result the finest level is enough.
  pair.num_levels = estimator == &estimators_.refining ? 1 : 0;
  estimator->Estimate(pair, start, estimate);
}

void DirectTracker::Judge(const Reference& reference,
                          const PreparedFrame& frame, bool is_alone,
                          TrackingResult* tracked) const {
  const ReferencePixels& ours = *reference.pixels;
  const MotionEstimate& estimate = tracked->estimate;
  tracked->num_found = estimate.num_used;
  tracked->overlap = ours.samples.SeenFrom(estimate.cur_from_prev);
  double& share = tracked->overlap.share;
  if (estimate.num_used > 0) {
    share *= static_cast<double>(estimate.num_inliers) / estimate.num_used;
  }
  const std::vector<cv::Mat>& levels = frame.Derived<SmoothPyramid>().levels;
  const size_t level =
      std::min({kLikenessLevel, ours.pyramid.size() - 1, levels.size() - 1});
  const ViewLikeness likeness = ours.samples.LikenessTo(
      frame, ours.pyramid[level], levels[level], estimate.cur_from_prev);
  const std::string few =
      Format("only %.0f %% of the reference agrees", 100.0 * share);
  tracked->status = TrackingStatus::kLost;
  tracked->needs_new_keyframe = false;
  if (!HasMotion(estimate)) {
    tracked->reason = estimate.reason;
  } else if (estimate.num_used < kMinPixels) {
    tracked->reason = Format("only %d pixels to compare", estimate.num_used);
  } else if (share < options_.min_seen_share) {
    tracked->reason = few;
  } else if (std::max(likeness.gray, likeness.depth) < options_.min_likeness) {
    tracked->reason = "the image differs too much from its reference";
  } else {
    const double rotation =
        LargestSigma(estimate.covariance.topLeftCorner<3, 3>());
    const double translation =
        LargestSigma(estimate.covariance.bottomRightCorner<3, 3>());
    tracked->needs_new_keyframe = share < kMinSeenShareOk;
    tracked->status = TrackingStatus::kDegraded;
    if (tracked->needs_new_keyframe) {
      tracked->reason = few;
    } else if (rotation > kMaxSigmaRotation) {
      tracked->reason = Format("rotation is uncertain by %.4f rad", rotation);
    } else if (translation > kMaxSigmaTranslation) {
      tracked->reason =
          Format("translation is uncertain by %.4f m", translation);
    } else if (is_alone && estimate.sigma > kMaxSigmaOk) {
      tracked->reason = Format("residuals are %.1f times as large as expected",
                               estimate.sigma);
    } else {
      tracked->status = TrackingStatus::kOk;
      tracked->reason.clear();
    }
  }
}

}  // namespace rgbd_pose
