#include "frontend/tracking/tracked_frame.h"

namespace rgbd_pose {

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

const char* ToString(TrackingSource source) {
  switch (source) {
    case TrackingSource::kNone:
      return "";
    case TrackingSource::kFeatures:
      return "features";
    case TrackingSource::kDirect:
      return "direct";
    case TrackingSource::kBoth:
      return "features+direct";
  }
  return "unknown";
}

}  // namespace rgbd_pose
