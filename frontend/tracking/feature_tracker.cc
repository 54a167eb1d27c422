#include "frontend/tracking/feature_tracker.h"

#include <cmath>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/stage_timer.h"
#include "frontend/tracking/seen_at.h"

namespace rgbd_pose {
namespace {

std::string OnlyInliers(int inliers) {
  return "only " + std::to_string(inliers) + " inliers";
}

double ShareOf(const FeatureReference& reference, const Tracked& tracked) {
  return static_cast<double>(tracked.estimate.num_inliers) /
         reference.trust.num_trusted();
}

double MeanInlierFlowPx(const FeatureMatches& found,
                        const MotionEstimate& estimate) {
  double sum = 0.0;
  int count = 0;
  for (size_t i = 0; i < found.matches.size(); ++i) {
    if (!estimate.is_inlier[i]) continue;
    const auto& [prev, cur] = found.matches[i];
    sum += std::hypot(cur.u - prev.u, cur.v - prev.v);
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace

FeatureReference::FeatureReference(const Camera& camera,
                                   std::unique_ptr<FeatureSet> features,
                                   FeatureTrust trust)
    : trust(std::move(trust)),
      camera_(camera),
      features_(std::move(features)) {}

Overlap FeatureReference::SeenFrom(const Rigid3d& cur_from_ref) const {
  Overlap overlap;
  int seen = 0;
  for (const Observation& o : features_->observations) {
    // Lens distortion does not matter here.
    const auto pixel = SeenAt(camera_, cur_from_ref, o);
    if (!pixel.has_value() || !camera_.Contains(*pixel)) continue;
    ++seen;
    overlap.flow_px += (*pixel - Eigen::Vector2d(o.u, o.v)).norm();
  }
  if (seen == 0) return overlap;
  overlap.share = static_cast<double>(seen) / features_->observations.size();
  overlap.flow_px /= seen;
  return overlap;
}

FeatureTracker::FeatureTracker(std::unique_ptr<Frontend> frontend,
                               Estimator estimator,
                               const TrackerOptions& options)
    : frontend_(std::move(frontend)),
      estimator_(std::move(estimator)),
      options_(options) {
  const std::string error = options.Check();
  if (!error.empty()) throw InputError("tracker: " + error);
}

std::unique_ptr<Reference> FeatureTracker::MakeReference(
    const PreparedFrame& frame, const Reference* last, const Tracked* tracked,
    std::string* why_not) {
  std::unique_ptr<FeatureSet> features = frontend_->Detect(frame);
  const size_t count = features->observations.size();
  // Trust is passed on from reference to reference as long as they are tracked;
  // where hardly any feature would have it the doubt itself is in doubt.
  FeatureTrust trust(count);
  if (last != nullptr) {
    trust = FeatureTrust(
        dynamic_cast<const FeatureReference&>(*last).features(),
        tracked->matches, tracked->doubted, tracked->estimate,
        frontend_->finds_all_in_view(), *features, 2 * options_.min_inliers_ok);
  }
  if (count < static_cast<size_t>(options_.min_inliers)) {
    *why_not =
        "only " + std::to_string(count) + " features with depth to start from";
    return nullptr;
  }
  return std::make_unique<FeatureReference>(images().camera,
                                            std::move(features), trust);
}

void FeatureTracker::Track(const Reference& reference,
                           const PreparedFrame& frame,
                           const Rigid3d& cur_from_ref_start,
                           const Rigid3d& cur_from_ref_guess,
                           const MotionMatrix* guess_covariance,
                           Tracked* tracked) {
  const auto& ours = dynamic_cast<const FeatureReference&>(reference);
  tracked->match_ms = 0.0;
  {
    const StageTimer timer(&tracked->match_ms);
    frontend_->Match(ours.features(), frame, cur_from_ref_start,
                     &tracked->matches);
    ours.trust.Split(&tracked->matches, &tracked->doubted);
  }
  tracked->carried_by = kName;
  tracked->num_found = static_cast<int>(tracked->matches.matches.size());
  Estimate(cur_from_ref_guess,
           PriorOf(options_, cur_from_ref_guess, guess_covariance), tracked);
  Judge(tracked);
  if (tracked->status == TrackingStatus::kLost) return;
  tracked->overlap = {ShareOf(ours, *tracked),
                      MeanInlierFlowPx(tracked->matches, tracked->estimate)};
  tracked->is_scarce = tracked->estimate.num_inliers < options_.min_inliers_ok;
}

void FeatureTracker::Believe(Reference* reference, Tracked* tracked) {
  auto& ours = dynamic_cast<FeatureReference&>(*reference);
  ours.trust.Learn(tracked->doubted, tracked->estimate.cur_from_prev);
  tracked->overlap.share = ShareOf(ours, *tracked);
}

void FeatureTracker::Estimate(const Rigid3d& cur_from_ref_start,
                              const MotionPrior& prior, Tracked* tracked) {
  const Correspondences& matches = tracked->matches.matches;
  Rigid3d start = cur_from_ref_start;
  if (options_.initial_guess != nullptr) {
    start = options_.initial_guess->find(matches).value_or(start);
  }
  estimator_.Estimate({&matches, &prior}, start, &tracked->estimate);
}

void FeatureTracker::Judge(Tracked* tracked) const {
  const MotionEstimate& estimate = tracked->estimate;
  const int inliers = estimate.num_inliers;
  tracked->status = TrackingStatus::kLost;
  tracked->reason = estimate.reason;
  if (estimate.status != EstimateStatus::kOk &&
      estimate.status != EstimateStatus::kNotConverged) {
    return;
  }
  if (inliers < options_.min_inliers) {
    tracked->reason = OnlyInliers(inliers);
    return;
  }
  tracked->status =
      estimate.ok() ? TrackingStatus::kOk : TrackingStatus::kDegraded;
  if (inliers < options_.min_inliers_ok) {
    tracked->status = TrackingStatus::kDegraded;
    tracked->reason = OnlyInliers(inliers);
  } else if (inliers < options_.min_inlier_share_ok * estimate.num_used) {
    tracked->status = TrackingStatus::kDegraded;
    tracked->reason = "only " + std::to_string(inliers) + " of " +
                      std::to_string(estimate.num_used) + " matches agree";
  } else if (estimate.sigma > options_.max_sigma_ok) {
    tracked->status = TrackingStatus::kDegraded;
    tracked->reason =
        "residuals spread by " + ShortNumber(estimate.sigma) + " sigmas";
  }
}

}  // namespace rgbd_pose
