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

}  // namespace rgbd_pose
