#include "frontend/mapping/mapping_options.h"

namespace rgbd_pose {

std::string MappingOptions::Check() const {
  if (max_pairs < 1) return "max_pairs must be at least 1";
  if (!(min_pair_share > 0.0 && min_pair_share <= 1.0)) {
    return "min_pair_share must be above 0 and at most 1";
  }
  if (max_loop_candidates < 0)
    return "max_loop_candidates must not be negative";
  if (!(redundant_share > 0.0)) return "redundant_share must be positive";
  if (window < 1) return "graph: window must be at least 1";
  if (!(drift > 0.0)) return "graph: drift must be positive";
  return "";
}

}  // namespace rgbd_pose
