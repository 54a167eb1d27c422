#include "core/estimation/motion_estimate.h"

namespace rgbd_pose {

const char* ToString(EstimateStatus status) {
  switch (status) {
    case EstimateStatus::kOk:
      return "ok";
    case EstimateStatus::kTooFewMatches:
      return "too_few_matches";
    case EstimateStatus::kDegenerate:
      return "degenerate";
    case EstimateStatus::kNotConverged:
      return "not_converged";
    case EstimateStatus::kInconsistent:
      return "inconsistent";
  }
  return "unknown";
}

}  // namespace rgbd_pose
