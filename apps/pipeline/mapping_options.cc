#include "apps/pipeline/mapping_options.h"

namespace rgbd_pose {

std::string MappingOptions::Check() const {
  if (max_pairs < 1) return "max_pairs must be at least 1";
  if (!(min_pair_share > 0.0 && min_pair_share <= 1.0)) {
    return "min_pair_share must be above 0 and at most 1";
  }
  if (!(max_pair_zoom >= 1.0)) return "max_pair_zoom must be at least 1";
  if (loop_hops < 1) return "loop_hops must be at least 1";
  if (max_lookalikes < 0) return "max_lookalikes must not be negative";
  if (!(max_pair_rotation > 0.0) || !(max_pair_translation > 0.0)) {
    return "what a pair may differ by must be positive";
  }
  if (!(min_seen_share >= 0.0) || !(max_pair_sigma > 0.0)) {
    return "min_seen_share must not be negative, max_pair_sigma be positive";
  }
  if (!(min_lookalike_inliers >= 0.0 && min_lookalike_inliers <= 1.0)) {
    return "min_lookalike_inliers must lie between 0 and 1";
  }
  if (!(redundant_share > 0.0) || !(redundant_flow_px >= 0.0)) {
    return "redundant_share must be positive, redundant_flow_px not negative";
  }
  return graph.Check();
}

}  // namespace rgbd_pose
