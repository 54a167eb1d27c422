#include "frontend/tracking/feature_validation.h"

#include <algorithm>
#include <utility>

#include "frontend/tracking/cell_counts.h"
#include "frontend/tracking/moving_regions.h"
#include "frontend/tracking/seen_at.h"

namespace rgbd_pose {
namespace {

// Number of frames in which a feature on probation has to agree. Until then, an
// object with a few centimetres per second has moved by several sigmas.
constexpr int kAgreements = 3;

// A single failed feature in a cell may be chance.
constexpr int kMinFailed = 2;

}  // namespace

FeatureValidation::FeatureValidation(
    const FeatureSet& last, const FeatureMatches& found,
    const FeatureMatches& on_probation, const MotionEstimate& estimate,
    bool missing_failed, const FeatureSet& fresh, size_t min_trusted)
    : agreements_needed_(fresh.observations.size(), 0) {
  const Camera& camera = found.matches.camera();
  std::vector<bool> agrees(last.observations.size(), false);
  std::vector<bool> counts(last.observations.size(), missing_failed);
  for (size_t i = 0; i < found.features.size(); ++i) {
    counts.at(found.features[i]) = true;  // throws if of another reference
    if (estimate.is_inlier[i]) agrees[found.features[i]] = true;
  }
  // Count these too: with frequent new references they would never be trusted.
  for (size_t i = 0; i < on_probation.features.size(); ++i) {
    counts.at(on_probation.features[i]) = true;
    agrees.at(on_probation.features[i]) =
        AgreesWithMotion(on_probation, i, estimate.cur_from_prev);
  }
  CellCounts agreed(camera), failed(camera);
  for (size_t i = 0; i < agrees.size(); ++i) {
    if (!counts[i]) continue;
    const auto pixel =
        SeenAt(camera, estimate.cur_from_prev, last.observations[i]);
    if (pixel.has_value()) ++(agrees[i] ? agreed : failed).At(*pixel);
  }
  for (size_t i = 0; i < agreements_needed_.size(); ++i) {
    const Observation& o = fresh.observations[i];
    const int failures = failed.At({o.u, o.v});
    if (failures >= kMinFailed && failures > agreed.At({o.u, o.v})) {
      agreements_needed_[i] = kAgreements;
    }
  }
  if (num_trusted() < min_trusted)
    agreements_needed_.assign(agreements_needed_.size(), 0);
}

size_t FeatureValidation::num_trusted() const {
  return std::count(agreements_needed_.begin(), agreements_needed_.end(), 0);
}

void FeatureValidation::Split(FeatureMatches* found,
                              FeatureMatches* on_probation) const {
  on_probation->Clear();
  if (num_trusted() == agreements_needed_.size()) return;
  FeatureMatches trusted{Correspondences(found->matches.camera()), {}};
  for (size_t i = 0; i < found->features.size(); ++i) {
    const bool is_trusted = agreements_needed_[found->features[i]] == 0;
    (is_trusted ? trusted : *on_probation).AddFrom(*found, i);
  }
  *found = std::move(trusted);
}

void FeatureValidation::Learn(const FeatureMatches& on_probation,
                              const Rigid3d& cur_from_ref) {
  for (size_t i = 0; i < on_probation.features.size(); ++i) {
    const bool agrees = AgreesWithMotion(on_probation, i, cur_from_ref);
    int& needed = agreements_needed_[on_probation.features[i]];
    needed = agrees ? needed - 1 : kAgreements;
  }
}

}  // namespace rgbd_pose
