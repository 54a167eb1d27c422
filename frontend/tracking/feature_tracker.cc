#include "frontend/tracking/feature_tracker.h"

#include <cmath>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/stage_timer.h"
#include "frontend/frame/observe.h"
#include "frontend/tracking/correlated_errors.h"

namespace rgbd_pose {
namespace {

// If a smaller share of the features is found, they are searched for again.
constexpr double kFewFound = 0.6;

// Minimum number of matches that agree on a second motion, as a share of the
// inliers of the first one. Fewer may be chance.
constexpr double kMinRival = 0.25;
// It is unknown which of two motions is the motion of the scene if the ratio of
// the image areas of their inliers (smaller to larger) exceeds this.
constexpr double kMaxRivalCells = 0.7;
// Features that agree in a smaller share of the view may lie on a moving
// object. One on 40 % of the view leaves 0.5 to 0.6; 95 % of real frames have
// more than 0.64.
constexpr double kMinAgreeingViewOk = 0.45;

// If a smaller share of a reference's features would be trusted, failures are
// those of the image, such as blur, and not of something that moves: that
// covers less of it, or it cannot be told from the scene.
constexpr double kMinTrustedShare = 0.3;

double ShareOf(const ReferenceFeatures& reference,
               const TrackingResult& tracked) {
  return static_cast<double>(tracked.estimate.num_inliers) /
         reference.validation.num_trusted();
}

double MeanInlierFlowPx(const TrackingResult& tracked) {
  double sum = 0.0;
  int count = 0;
  for (size_t i = 0; i < tracked.matches.matches.size(); ++i) {
    if (!tracked.estimate.is_inlier[i]) continue;
    const auto& [prev, cur] = tracked.matches.matches[i];
    sum += std::hypot(cur.u - prev.u, cur.v - prev.v);
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace

FeatureTracker::FeatureTracker(std::unique_ptr<Frontend> frontend,
                               Estimator estimator,
                               const TrackerOptions& options)
    : frontend_(std::move(frontend)),
      estimator_(std::move(estimator)),
      options_(options),
      other_(images().camera) {
  RequireSound(options.Check(), "tracker: ");
}

std::unique_ptr<Reference> FeatureTracker::MakeReference(
    const PreparedFrame& frame, const Reference* last,
    const TrackingResult* tracked, std::string* why_not) {
  std::unique_ptr<FeatureSet> features = frontend_->Detect(frame);
  const size_t count = features->observations.size();
  // Failures are passed on from reference to reference while tracking succeeds.
  // If hardly any feature would be trusted, all are.
  FeatureValidation validation(count);
  if (last != nullptr) {
    validation = FeatureValidation(
        *last->features->features, *tracked, frontend_->is_exhaustive(),
        *features,
        std::max<size_t>(2 * options_.min_inliers_ok,
                         kMinTrustedShare * static_cast<double>(count)));
  }
  if (count < static_cast<size_t>(options_.min_inliers)) {
    *why_not = "only " + std::to_string(count) + " features with depth";
    return nullptr;
  }
  auto reference = std::make_unique<Reference>();
  reference->features = std::make_unique<ReferenceFeatures>(
      images().camera, std::move(features), std::move(validation));
  return reference;
}

void FeatureTracker::MoveReference(const PreparedFrame& frame,
                                   const Rigid3d& reference_from_stamp,
                                   Reference* reference) const {
  frontend_->ObserveAgain(frame, reference_from_stamp,
                          reference->features->features.get());
}

void FeatureTracker::Track(const Reference& reference,
                           const PreparedFrame& frame,
                           const TrackingGuess& guess,
                           TrackingResult* tracked) {
  const ReferenceFeatures& ours = *reference.features;
  tracked->Begin(TrackingSource::kFeatures);
  tracked->prior = PriorOf(options_, guess);
  const auto track = [&](const PreparedFrame& seen, const Rigid3d& search_at,
                         const Rigid3d& start) {
    {
      const StageTimer timer(&tracked->match_ms);
      frontend_->Match(*ours.features, seen, search_at, &tracked->matches);
      ours.validation.Split(&tracked->matches, &tracked->on_probation);
    }
    Estimate(start, tracked);
    ChooseMotion(tracked);
    if (guess.velocity != nullptr) {
      FindTwist(*ours.features, seen, *guess.velocity, tracked);
    }
  };
  track(frame, guess.search_at.value_or(guess.cur_from_ref),
        guess.cur_from_ref);
  // With a wrong velocity, few features were where they were searched for.
  if (guess.velocity != nullptr && tracked->estimate.ok() &&
      ShareOf(ours, *tracked) < kFewFound) {
    const Rigid3d found = tracked->estimate.cur_from_prev;
    track(frame.WithTwist(tracked->velocity->twist), found, found);
  }
  Complete(ours, tracked);
}

void FeatureTracker::TrackAgain(const Reference& reference,
                                const PreparedFrame& frame,
                                const TrackingGuess& guess,
                                TrackingResult* tracked) {
  const ReferenceFeatures& ours = *reference.features;
  for (FeatureMatches* part : {&tracked->matches, &tracked->on_probation}) {
    const FeatureMatches before = *part;
    part->Clear();
    for (size_t i = 0; i < before.features.size(); ++i) {
      part->Add(*ours.features, before.features[i], before.matches[i].cur);
    }
  }
  Estimate(guess.cur_from_ref, tracked);
  ChooseMotion(tracked);
  if (guess.velocity != nullptr) {
    FindTwist(*ours.features, frame, *guess.velocity, tracked);
  }
  Complete(ours, tracked);
}

void FeatureTracker::Complete(const ReferenceFeatures& ours,
                              TrackingResult* tracked) const {
  tracked->covariance_factor =
      CovarianceInflation(tracked->matches.matches, tracked->estimate);
  tracked->estimate.covariance *= tracked->covariance_factor;
  tracked->num_found = static_cast<int>(tracked->matches.matches.size());
  Judge(tracked);
  if (tracked->status == TrackingStatus::kLost) return;
  const double agreeing_view =
      MarkMoving(*ours.features, frontend_->is_exhaustive(), tracked);
  if (tracked->status == TrackingStatus::kOk &&
      agreeing_view < kMinAgreeingViewOk) {
    tracked->is_ambiguous = true;
    tracked->status = TrackingStatus::kDegraded;
    tracked->reason = Format("features agree in only %.0f %% of the view",
                             100.0 * agreeing_view);
  }
  tracked->overlap = {ShareOf(ours, *tracked), MeanInlierFlowPx(*tracked)};
  tracked->needs_new_keyframe =
      tracked->estimate.num_inliers < options_.min_inliers_ok;
}

void FeatureTracker::ChooseMotion(TrackingResult* tracked) {
  tracked->is_ambiguous = false;
  const MotionEstimate& estimate = tracked->estimate;
  const auto is_worth_a_look = [&](int inliers) {
    return inliers >= options_.min_inliers &&
           inliers >= kMinRival * estimate.num_inliers;
  };
  if (!estimate.ok() ||
      !is_worth_a_look(estimate.num_used - estimate.num_inliers)) {
    return;
  }
  other_.prior = tracked->prior;
  other_.matches.Clear();
  other_.on_probation = tracked->on_probation;
  const FeatureMatches& all = tracked->matches;
  for (size_t i = 0; i < all.features.size(); ++i) {
    (estimate.is_inlier[i] ? other_.on_probation : other_.matches)
        .AddFrom(all, i);
  }
  Estimate(estimate.cur_from_prev, &other_);
  if (!other_.estimate.ok() || !is_worth_a_look(other_.estimate.num_inliers)) {
    return;
  }
  const int cells = CellsOfInliers(*tracked);
  const int other_cells = CellsOfInliers(other_);
  tracked->is_ambiguous = std::min(cells, other_cells) >
                          kMaxRivalCells * std::max(cells, other_cells);
  if (other_cells <= cells) return;
  std::swap(tracked->matches, other_.matches);
  std::swap(tracked->on_probation, other_.on_probation);
  std::swap(tracked->estimate, other_.estimate);
}

void FeatureTracker::FindTwist(const FeatureSet& features, const Frame& frame,
                               const VelocityPrior& velocity,
                               TrackingResult* tracked) {
  constexpr int kMaxRounds = 3;
  constexpr double kSmallFlowPx = 0.05;
  const MotionEstimate& estimate = tracked->estimate;
  Frame seen = frame;
  seen.twist = frame.twist.value_or(Twist());
  // If the velocity is unknown, nothing has been moved yet.
  FrameTiming moved_by = frame.Timing();
  // If the motion is too doubtful to estimate the velocity.
  TwistEstimate found = ExpectedTwist(seen.Timing(), velocity);
  for (int round = 0; round < kMaxRounds && estimate.ok(); ++round) {
    found = EstimateTwist(tracked->matches.matches, estimate.is_inlier,
                          estimate.sigma, estimate.cur_from_prev, seen.Timing(),
                          velocity.Mean(estimate.cur_from_prev, moved_by.twist),
                          velocity);
    found.motion_covariance +=
        MotionCovarianceOfAcceleration(seen.Timing(), velocity);
    const Twist change = found.twist - moved_by.twist;
    if (LargestFlow(images().camera, seen.Timing(), change) < kSmallFlowPx) {
      break;
    }
    seen.twist = found.twist;
    for (FeatureMatches* part : {&tracked->matches, &tracked->on_probation}) {
      const FeatureMatches before = *part;
      part->Clear();
      for (size_t i = 0; i < before.features.size(); ++i) {
        part->Add(features, before.features[i],
                  ObserveAgain(seen, images().camera, moved_by,
                               before.matches[i].cur, images().depth));
      }
    }
    moved_by = seen.Timing();
    Estimate(estimate.cur_from_prev, tracked);
  }
  found.twist = moved_by.twist;
  tracked->velocity = found;
  tracked->estimate.covariance += found.motion_covariance;
}

void FeatureTracker::OnAccepted(Reference* reference, TrackingResult* tracked) {
  ReferenceFeatures& ours = *reference->features;
  ours.validation.Learn(tracked->on_probation, tracked->estimate.cur_from_prev);
  tracked->overlap.share = ShareOf(ours, *tracked);
}

void FeatureTracker::Estimate(Rigid3d start, TrackingResult* tracked) {
  const Correspondences& matches = tracked->matches.matches;
  if (options_.initial_guess != nullptr) {
    start = options_.initial_guess->find(matches).value_or(start);
  }
  estimator_.Estimate({&matches, &tracked->prior}, start, &tracked->estimate);
}

void FeatureTracker::Judge(TrackingResult* tracked) const {
  const MotionEstimate& estimate = tracked->estimate;
  const int inliers = estimate.num_inliers;
  const std::string few = Format("only %d inliers", inliers);
  tracked->status = TrackingStatus::kLost;
  tracked->reason = estimate.reason;
  if (!HasMotion(estimate)) return;
  if (inliers < options_.min_inliers) {
    tracked->reason = few;
    return;
  }
  tracked->status = TrackingStatus::kDegraded;
  if (tracked->is_ambiguous) {
    tracked->reason = "matches agree with two motions";
  } else if (inliers < options_.min_inliers_ok) {
    tracked->reason = few;
  } else if (inliers < options_.min_inlier_share_ok * estimate.num_used) {
    tracked->reason =
        Format("only %d of %d matches agree", inliers, estimate.num_used);
  } else if (estimate.sigma > options_.max_sigma_ok) {
    tracked->reason =
        Format("residuals are %.1f times as large as expected", estimate.sigma);
  } else if (estimate.ok()) {
    tracked->status = TrackingStatus::kOk;
  }
}

}  // namespace rgbd_pose
