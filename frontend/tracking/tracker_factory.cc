#include "frontend/tracking/tracker_factory.h"

#include <utility>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "frontend/tracking/feature_tracker.h"
#include "frontend/tracking/hybrid_tracker.h"

namespace rgbd_pose {
namespace {

using Make = std::unique_ptr<Tracker> (*)(TrackerParts parts);

std::unique_ptr<FeatureTracker> ByFeatures(TrackerParts* parts) {
  return std::make_unique<FeatureTracker>(
      MakeFrontend(parts->frontend, parts->images), std::move(parts->estimator),
      parts->options);
}

std::unique_ptr<DirectTracker> ByPixels(TrackerParts* parts) {
  if (!parts->direct_estimators.has_value()) {
    throw InputError("a direct tracker needs estimators of direct costs");
  }
  return std::make_unique<DirectTracker>(
      parts->images, *std::move(parts->direct_estimators), parts->options);
}

std::unique_ptr<Tracker> MakeFeatureTracker(TrackerParts parts) {
  if (!parts.direct_estimators.has_value()) return ByFeatures(&parts);
  return std::make_unique<HybridTracker>(ByFeatures(&parts), ByPixels(&parts),
                                         /*refines=*/false);
}

std::unique_ptr<Tracker> MakeDirectTracker(TrackerParts parts) {
  return ByPixels(&parts);
}

std::unique_ptr<Tracker> MakeHybridTracker(TrackerParts parts) {
  return std::make_unique<HybridTracker>(ByFeatures(&parts), ByPixels(&parts),
                                         /*refines=*/true);
}

// A new tracker needs one header and one row here.
constexpr Named<Make> kTrackers[] = {
    {"features", MakeFeatureTracker},
    {"direct", MakeDirectTracker},
    {"hybrid", MakeHybridTracker},
};

}  // namespace

std::vector<std::string> TrackerNames() { return NamesOf(kTrackers); }

std::unique_ptr<Tracker> MakeTracker(std::string_view name,
                                     TrackerParts parts) {
  return RowOf(kTrackers, "tracker", name).value(std::move(parts));
}

}  // namespace rgbd_pose
