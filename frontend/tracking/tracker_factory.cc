#include "frontend/tracking/tracker_factory.h"

#include <utility>

#include "core/util/named_values.h"
#include "frontend/tracking/feature_tracker.h"

namespace rgbd_pose {
namespace {

using Make = std::unique_ptr<Tracker> (*)(TrackerParts parts);

std::unique_ptr<Tracker> MakeFeatureTracker(TrackerParts parts) {
  return std::make_unique<FeatureTracker>(
      MakeFrontend(parts.frontend, parts.images), std::move(parts.estimator),
      parts.options);
}

// One header and one row here make a tracker.
constexpr Named<Make> kTrackers[] = {
    {FeatureTracker::kName, MakeFeatureTracker},
};

}  // namespace

std::vector<std::string> TrackerNames() { return NamesOf(kTrackers); }

std::unique_ptr<Tracker> MakeTracker(std::string_view name,
                                     TrackerParts parts) {
  return ValueOf(kTrackers, "tracker", std::string(name))(std::move(parts));
}

}  // namespace rgbd_pose
