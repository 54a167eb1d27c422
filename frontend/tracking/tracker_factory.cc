#include "frontend/tracking/tracker_factory.h"

#include <utility>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "frontend/tracking/feature_tracker.h"
#include "frontend/tracking/hybrid_tracker.h"

namespace rgbd_pose {
namespace {

enum class TrackerKind { kFeatures, kDirect, kHybrid };

// A new tracker needs a header, its kind and row here, and its making below.
constexpr Named<TrackerKind> kTrackers[] = {
    {"features", TrackerKind::kFeatures},
    {"direct", TrackerKind::kDirect},
    {"hybrid", TrackerKind::kHybrid},
};

}  // namespace

std::vector<std::string> TrackerNames() { return NamesOf(kTrackers); }

std::unique_ptr<Tracker> MakeTracker(std::string_view name,
                                     TrackerParts parts) {
  const TrackerKind kind = RowOf(kTrackers, "tracker", name).value;
  std::unique_ptr<DirectTracker> direct;
  if (parts.direct_estimators.has_value()) {
    direct = std::make_unique<DirectTracker>(
        parts.images, *std::move(parts.direct_estimators), parts.options);
  } else if (kind != TrackerKind::kFeatures) {
    throw InputError("a direct tracker needs estimators of direct costs");
  }
  auto frontend = MakeFrontend(parts.frontend, parts.images);
  if (kind == TrackerKind::kDirect) return direct;
  auto features = std::make_unique<FeatureTracker>(
      std::move(frontend), std::move(parts.estimator), parts.options);
  if (direct == nullptr) return features;
  return std::make_unique<HybridTracker>(std::move(features), std::move(direct),
                                         kind == TrackerKind::kHybrid);
}

}  // namespace rgbd_pose
