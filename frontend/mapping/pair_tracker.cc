#include "frontend/mapping/pair_tracker.h"

#include <algorithm>
#include <string>

namespace rgbd_pose {
namespace {

// Number of references kept, about 3 MB each.
constexpr size_t kMaxReferences = 24;

// Limits of a good pair: the share of the view that is visible, and the spread
// of the residuals in sigmas.
constexpr double kMinSeenShare = 0.1;
constexpr double kMaxPairSigma = 3.0;

// A pair that differs from its initial guess, by poses or descriptors, by more
// than this is wrong.
constexpr double kMaxPairRotation = 0.2;     // rad
constexpr double kMaxPairTranslation = 0.3;  // m

}  // namespace

std::optional<RelativePose> PairTracker::MakePair(
    int ref, int cur, const Keyframe& keyframe, const PreparedFrame& frame,
    const Rigid3d& cur_from_ref_guess, double min_inlier_share) {
  const Reference* reference = ReferenceOf(ref, keyframe);
  if (reference == nullptr) return std::nullopt;
  tracker_->Track(*reference, frame, cur_from_ref_guess, &tracked_);
  const MotionEstimate& estimate = tracked_.estimate;
  if (tracked_.status != TrackingStatus::kOk || !estimate.ok() ||
      estimate.num_inliers < min_inlier_share * estimate.num_used ||
      estimate.sigma > kMaxPairSigma ||
      tracked_.overlap.share < kMinSeenShare ||
      !IsWithin(estimate.cur_from_prev, cur_from_ref_guess, kMaxPairRotation,
                kMaxPairTranslation)) {
    return std::nullopt;
  }
  return RelativePose{ref, cur, estimate.cur_from_prev, estimate.covariance};
}

void PairTracker::Forget(int keyframe) {
  references_.remove_if(
      [=](const auto& entry) { return entry.first == keyframe; });
}

const Reference* PairTracker::ReferenceOf(int at, const Keyframe& keyframe) {
  const auto made =
      std::find_if(references_.begin(), references_.end(),
                   [=](const auto& entry) { return entry.first == at; });
  if (made != references_.end()) {
    references_.splice(references_.begin(), references_, made);
    return references_.front().second.get();
  }
  std::string why_not;
  auto reference =
      tracker_->MakeReference(keyframe.Unpacked(), nullptr, nullptr, &why_not);
  if (reference == nullptr) return nullptr;
  if (references_.size() == kMaxReferences) references_.pop_back();
  references_.emplace_front(at, std::move(reference));
  return references_.front().second.get();
}

}  // namespace rgbd_pose
