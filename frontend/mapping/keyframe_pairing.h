#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "frontend/mapping/keyframe_graph.h"
#include "frontend/mapping/map_update.h"
#include "frontend/mapping/mapping_options.h"
#include "frontend/mapping/pair_tracker.h"
#include "frontend/places/place_database.h"

namespace rgbd_pose {

// Finds keyframes that see the same place as a new one and adds pairs with them
// to a graph. Keyframes are identified by their numbers in the graph.
class KeyframePairing {
 public:
  // All arguments must outlive this object.
  KeyframePairing(const MappingOptions& options,
                  const std::deque<MappedKeyframe>& keyframes,
                  const PlaceDatabase& index, PairTracker* tracker,
                  KeyframeGraph* graph)
      : options_(options),
        keyframes_(keyframes),
        index_(index),
        tracker_(*tracker),
        graph_(*graph) {}

  // Pairs the newest keyframe with those of its segment that, by their poses,
  // see the same.
  void PairByPose(int newest, const PreparedFrame& frame, MapUpdate* update);

  // Pairs it with similar ones of any segment. Segments that meet are joined.
  void CloseLoopsByAppearance(int newest, const PreparedFrame& frame,
                              MapUpdate* update);

 private:
  // A motion between two segments that only one pair supports so far.
  struct Meeting {
    int ref_segment = 0, cur_segment = 0;
    Rigid3d ref_from_cur;  // between their world frames
  };

  // The share of each view that the other one sees, the smaller of both. 0 if
  // their scales differ too much.
  double SharedView(int ref, int cur, const Rigid3d& cur_from_ref) const;
  std::vector<int> SeeingTheSame(int newest) const;
  std::optional<RelativePose> MakePair(int ref, int cur,
                                       const PreparedFrame& frame,
                                       const Rigid3d& cur_from_ref_guess,
                                       double min_inlier_share);
  bool AgreesWithOthers(const RelativePose& edge, const PreparedFrame& frame);
  bool AreConnected(const RelativePose& edge);

  const MappingOptions& options_;
  const std::deque<MappedKeyframe>& keyframes_;
  const PlaceDatabase& index_;
  PairTracker& tracker_;
  KeyframeGraph& graph_;
  std::vector<Meeting> meetings_;
};

}  // namespace rgbd_pose
