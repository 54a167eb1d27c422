#include "frontend/tracking/direct_tracker.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/stage_timer.h"
#include "frontend/frame/image_pyramid.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// Distance between the samples that determine the overlap.
constexpr int kSampleStepPx = 20;
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

// With pixels alone it is degraded if its residuals have a larger spread, in
// sigmas. Measured: right motions have 0.8, with blur 1.9; wrong ones 2 to 5.
constexpr double kMaxSigmaOk = 2.0;

// Returns the largest standard deviation in any direction of a covariance.
double LargestSigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
      covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
}

}  // namespace

std::string DirectTrackerOptions::Check() const {
  if (!(min_seen_share >= 0.0 && min_seen_share <= 1.0)) {
    return "min_seen_share must be from 0 to 1";
  }
  if (!(min_likeness >= -1.0 && min_likeness <= 1.0)) {
    return "min_likeness must be from -1 to 1";
  }
  return "";
}

DirectReference::DirectReference(const PreparedFrame& frame,
                                 const FrontendOptions& images, uint64_t id)
    : depth_(frame.depth),
      pyramid_(frame.Derived<SmoothPyramid>().levels),
      samples_(frame, images.camera, kSampleStepPx, images.min_depth,
               images.max_depth) {
  view_ = ViewFrame(frame, pyramid_, images.camera, images.depth_noise);
  view_.id = id;
}

ViewLikeness DirectReference::LikenessTo(const PreparedFrame& cur,
                                         const Rigid3d& cur_from_ref) const {
  const std::vector<cv::Mat>& pyramid = cur.Derived<SmoothPyramid>().levels;
  const size_t level =
      std::min({kLikenessLevel, pyramid_.size() - 1, pyramid.size() - 1});
  return samples_.LikenessTo(cur, pyramid_[level], pyramid[level],
                             cur_from_ref);
}

DirectTracker::DirectTracker(const FrontendOptions& images,
                             DirectEstimators estimators,
                             const TrackerOptions& common,
                             const DirectTrackerOptions& options)
    : images_(images),
      estimators_(std::move(estimators)),
      common_(common),
      options_(options) {
  for (const std::string& error :
       {images.Check(), common.Check(), options.Check()}) {
    if (!error.empty()) throw InputError("tracker: " + error);
  }
}

void DirectTracker::Prepare(const PreparedFrame& frame) const {
  frame.Derived<SmoothPyramid>();
}

std::unique_ptr<Reference> DirectTracker::MakeReference(
    const PreparedFrame& frame, const Reference* /*last*/,
    const TrackingResult* /*tracked*/, std::string* why_not) {
  auto reference =
      std::make_unique<DirectReference>(frame, images_, ++last_id_);
  if (reference->num_samples() < kMinSamples) {
    *why_not = "too few pixels with depth";
    return nullptr;
  }
  return reference;
}

void DirectTracker::Track(const Reference& reference,
                          const PreparedFrame& frame,
                          const TrackingGuess& guess, TrackingResult* tracked) {
  Begin(tracked);
  Estimate(reference, frame, frame.Timing(), guess.cur_from_ref, guess, 0,
           &estimators_.leading, &tracked->estimate);
  if (tracked->estimate.num_used > 0) {
    const Rigid3d found = tracked->estimate.cur_from_prev;
    Estimate(reference, frame, frame.Timing(), found, guess, 1,
             &estimators_.refining, &tracked->estimate);
  }
  if (guess.velocity != nullptr) FindTwist(reference, frame, guess, tracked);
  Judge(reference, frame, tracked);
  // If features have led the way, the result can be compared with them. Pixels
  // alone have to fit.
  const double sigma = tracked->estimate.sigma;
  if (tracked->status == TrackingStatus::kOk && sigma > kMaxSigmaOk) {
    tracked->status = TrackingStatus::kDegraded;
    tracked->reason =
        Format("residuals are %.1f times as large as expected", sigma);
  }
}

void DirectTracker::Refine(const Reference& reference,
                           const PreparedFrame& frame, const MotionPrior& prior,
                           const TrackingResult& by_features,
                           TrackingResult* tracked) {
  Begin(tracked);
  const FrameView view = ViewOf(frame, frame.Timing(), &by_features.moving);
  FramePair pair;
  pair.matches = &by_features.matches.matches;
  pair.prior = &prior;
  pair.prev = reference.images();
  pair.cur = &view;
  pair.num_levels = 1;
  estimators_.refining.Estimate(pair, by_features.estimate.cur_from_prev,
                                &tracked->estimate);
  Judge(reference, frame, tracked);
}

void DirectTracker::FindTwist(const Reference& reference,
                              const PreparedFrame& frame,
                              const TrackingGuess& guess,
                              TrackingResult* tracked) {
  constexpr int kMaxRounds = 2;
  constexpr double kSmallFlowPx = 0.2;
  MotionEstimate* const estimate = &tracked->estimate;
  FrameTiming timing = frame.Timing(frame.twist.value_or(Twist()));
  for (int round = 0; estimate->ok(); ++round) {
    const Twist twist =
        guess.velocity->Mean(estimate->cur_from_prev, timing.twist);
    const bool is_small = LargestFlow(images_.camera, timing,
                                      twist - timing.twist) < kSmallFlowPx;
    if (is_small || round == kMaxRounds) break;
    timing.twist = twist;
    Estimate(reference, frame, timing, Rigid3d(estimate->cur_from_prev), guess,
             1, &estimators_.refining, estimate);
  }
  tracked->twist = timing.twist;
  tracked->twist_covariance = MotionCovarianceOfTwist(
      timing, guess.velocity->sigma_angular, guess.velocity->sigma_linear);
  estimate->covariance += tracked->twist_covariance;
}

Rigid3d DirectTracker::FindStart(const Reference& reference,
                                 const PreparedFrame& frame,
                                 const TrackingGuess& guess) {
  if (!estimators_.coarse.has_value()) return guess.cur_from_ref;
  Estimate(reference, frame, frame.Timing(), guess.cur_from_ref, guess, 0,
           &*estimators_.coarse, &start_);
  const bool is_found =
      start_.ok() || start_.status == EstimateStatus::kNotConverged;
  return is_found ? start_.cur_from_prev : guess.cur_from_ref;
}

FrameView DirectTracker::ViewOf(const PreparedFrame& frame,
                                const FrameTiming& timing,
                                const CellMask* moving) const {
  FrameView view = ViewFrame(frame, frame.Derived<SmoothPyramid>().levels,
                             images_.camera, images_.depth_noise);
  view.timing = timing;
  view.moving = moving;
  return view;
}

void DirectTracker::Estimate(const Reference& reference,
                             const PreparedFrame& frame,
                             const FrameTiming& timing, const Rigid3d& start,
                             const TrackingGuess& guess, int num_levels,
                             Estimator* estimator,
                             MotionEstimate* estimate) const {
  const FrameView view = ViewOf(frame, timing, nullptr);
  const MotionPrior prior = Prior(guess);
  FramePair pair;
  pair.prior = &prior;
  pair.prev = reference.images();
  pair.cur = &view;
  pair.num_levels = num_levels;
  estimator->Estimate(pair, start, estimate);
}

void DirectTracker::Begin(TrackingResult* tracked) {
  tracked->matches.Clear();
  tracked->on_probation.Clear();
  tracked->is_ambiguous = false;
  tracked->prior_of_refinement.reset();
  tracked->match_ms = 0.0;
  tracked->source = TrackingSource::kDirect;
  tracked->twist.reset();
  tracked->twist_covariance.setZero();
}

void DirectTracker::Judge(const Reference& reference,
                          const PreparedFrame& frame,
                          TrackingResult* tracked) const {
  const auto& ours = dynamic_cast<const DirectReference&>(reference);
  const MotionEstimate& estimate = tracked->estimate;
  tracked->num_found = estimate.num_used;
  tracked->overlap = ours.SeenFrom(estimate.cur_from_prev);
  if (estimate.num_used > 0) {
    tracked->overlap.share *=
        static_cast<double>(estimate.num_inliers) / estimate.num_used;
  }
  JudgeMotion(ours.LikenessTo(frame, estimate.cur_from_prev), tracked);
  tracked->needs_new_keyframe = tracked->status != TrackingStatus::kLost &&
                                tracked->overlap.share < kMinSeenShareOk;
}

void DirectTracker::JudgeMotion(const ViewLikeness& likeness,
                                TrackingResult* tracked) const {
  const MotionEstimate& estimate = tracked->estimate;
  const double share = tracked->overlap.share;
  tracked->status = TrackingStatus::kLost;
  tracked->reason = estimate.reason;
  // kNotConverged is accepted: its last step is some hundredths of a pixel.
  if (!estimate.ok() && estimate.status != EstimateStatus::kNotConverged) {
    return;
  }
  if (estimate.num_used < kMinPixels) {
    tracked->reason = Format("only %d pixels to compare", estimate.num_used);
    return;
  }
  if (share < options_.min_seen_share) {
    tracked->reason =
        Format("only %.0f %% of the reference agrees", 100.0 * share);
    return;
  }
  if (std::max(likeness.gray, likeness.depth) < options_.min_likeness) {
    tracked->reason = "the image differs too much from its reference";
    return;
  }
  const double rotation =
      LargestSigma(estimate.covariance.topLeftCorner<3, 3>());
  const double translation =
      LargestSigma(estimate.covariance.bottomRightCorner<3, 3>());
  tracked->status = TrackingStatus::kDegraded;
  if (share < kMinSeenShareOk) {
    tracked->reason =
        Format("only %.0f %% of the reference agrees", 100.0 * share);
  } else if (rotation > kMaxSigmaRotation) {
    tracked->reason = Format("rotation is uncertain by %.4f rad", rotation);
  } else if (translation > kMaxSigmaTranslation) {
    tracked->reason = Format("translation is uncertain by %.4f m", translation);
  } else {
    tracked->status = TrackingStatus::kOk;
    tracked->reason.clear();
  }
}

}  // namespace rgbd_pose
