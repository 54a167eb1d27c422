#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"
#include "frontend/map/keyframe_map.h"
#include "frontend/mapping/keyframe_graph.h"
#include "frontend/mapping/keyframe_pairing.h"
#include "frontend/mapping/map_update.h"
#include "frontend/mapping/mapping_options.h"
#include "frontend/mapping/pair_tracker.h"
#include "frontend/places/place_database.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// Builds a map of keyframes. Finds keyframes that see the same place by their
// poses or appearance (PlaceDatabase), measures the motions between them
// (Tracker), and keeps all poses consistent (KeyframeGraph). Not thread-safe.
class Mapper {
 public:
  // `tracker` measures pairs. Throws InputError for invalid options.
  Mapper(const MappingOptions& options, std::unique_ptr<Tracker> tracker);

  // Starts with an existing map; to be called before Add. With `is_held` its
  // poses never move, and no keyframe is removed. Several maps are segments
  // that are joined where they meet. Throws InputError for a map that is
  // invalid or of another camera.
  void Load(const KeyframeMap& map, bool is_held);

  // Adds a keyframe. `edges` to earlier keyframes (by id; the new one is `cur`)
  // give its pose; without edges its own pose is used.
  MapUpdate Add(Keyframe keyframe, const std::vector<RelativePose>& edges);

  // Relocalises a lost frame in the whole map; returns a keyframe of the place.
  std::optional<Keyframe> Find(const Frame& lost);

  // Optimises all poses.
  MapUpdate Finish();

  // All keyframes that were not removed, and their pairs. Covariances are as
  // measured, or `as_solved` by KeyframeGraph::CovarianceAsSolved.
  KeyframeMap Map(bool as_solved = false) const;

  // Covariances in the order of keyframes in Map(), see KeyframeGraph.
  std::vector<MotionMatrix> Covariances() const;
  const KeyframeGraph& graph() const { return graph_; }

 private:
  // Compresses the images of a keyframe; returns its number in graph_.
  int AddKeyframe(Keyframe keyframe, const PreparedFrame& frame, bool is_held);
  void Index(int at);
  // A keyframe with decompressed images.
  Keyframe WithImages(int at) const;
  void FindReturn(int newest, MapUpdate* update) const;
  void CullKeyframes(int newest);
  void PublishMovedPoses(MapUpdate* update);

  const MappingOptions options_;
  PairTracker tracker_;
  KeyframeGraph graph_;
  std::deque<MappedKeyframe> keyframes_;  // by number in graph_
  std::map<int, int> numbers_;            // by keyframe id
  PlaceDatabase index_;
  KeyframePairing pairing_;
};

}  // namespace rgbd_pose
