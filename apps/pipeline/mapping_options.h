#pragma once

#include <string>

#include "apps/pipeline/keyframe_graph.h"

namespace rgbd_pose {

// Which keyframes are joined to which.
struct MappingOptions {
  // A new keyframe is paired with at most so many older ones that see the same:
  // half of them those that see most of it, half the oldest, which hold the
  // drift.
  int max_pairs = 8;

  // Two see the same if each shows such a share of the other.
  double min_pair_share = 0.4;

  // And neither shows things so much larger than the other: what one sees from
  // near by the other sees from far away, where depth is not to be trusted.
  double max_pair_zoom = 1.5;

  // A pair closes a loop if it joins keyframes that were more than so many
  // pairs apart.
  int loop_hops = 4;

  // So many keyframes that look alike are asked whether they show the same
  // place; 0: loops are found by pose alone, and segments are not joined.
  int max_lookalikes = 4;

  // A pair is wrong if it differs from what the poses or the descriptors say by
  // more than this.
  double max_pair_rotation = 0.2;     // rad
  double max_pair_translation = 0.3;  // m

  // Of a good pair the tracker sees at least such a share, and its residuals
  // spread by no more sigmas.
  double min_seen_share = 0.1;
  double max_pair_sigma = 3.0;

  // A pair found by looks alone needs such a share of inliers.
  double min_lookalike_inliers = 0.5;

  // A keyframe makes way if an older one sees such a share of it, so near (px):
  // a map grows with the place, not with time.
  double redundant_share = 0.85;
  double redundant_flow_px = 30.0;

  KeyframeGraphOptions graph;  // how poses follow from pairs

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

}  // namespace rgbd_pose
