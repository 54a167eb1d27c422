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

// Joins keyframes to a map: pairs them with those that see the same (Tracker),
// found by their poses or by their looks (PlaceDatabase), and keeps all poses
// in agreement (KeyframeGraph). For one thread.
class Mapper {
 public:
  // `tracker` makes pairs. Throws InputError for options that are not sound.
  Mapper(const MappingOptions& options, std::unique_ptr<Tracker> tracker);

  // Begins with a map. `is_held`: its poses never move, and none is removed. To
  // be called first; several maps are segments that are joined where they meet.
  // Throws InputError for a map of another camera or one that is not sound.
  void Load(const KeyframeMap& map, bool is_held);

  // Takes a keyframe in, where its edges to earlier ones (by id; it is `cur`)
  // lead, or, without any, where its pose is.
  MapUpdate Add(Keyframe keyframe, const std::vector<RelativePose>& edges);

  // Looks for a lost frame in the whole map.
  std::optional<Keyframe> Find(const Frame& lost);

  // Solves for all poses.
  MapUpdate Finish();

  // All keyframes that were not removed, and their pairs: as they were
  // measured, or `as_solved`, see KeyframeGraph::CovarianceAsSolved.
  KeyframeMap Map(bool as_solved = false) const;

  // By the places of its keyframes in Map(): see KeyframeGraph.
  std::vector<MotionMatrix> Covariances() const;
  const KeyframeGraph& graph() const { return graph_; }

 private:
  // Packs its images; returns its number in graph_.
  int AddKeyframe(Keyframe keyframe, const PreparedFrame& frame, bool is_held);
  void Index(int at);
  // A keyframe, unpacked.
  Keyframe WithImages(int at) const;
  void FindReturn(int newest, MapUpdate* update) const;
  void CullKeyframes(int newest);
  void PublishMovedPoses(MapUpdate* update);

  const MappingOptions options_;
  PairTracker tracker_;
  KeyframeGraph graph_;
  std::deque<MappedKeyframe> keyframes_;  // by their numbers in graph_
  std::map<int, int> numbers_;            // of keyframes, by id
  PlaceDatabase index_;
  KeyframePairing pairing_;
};

}  // namespace rgbd_pose
