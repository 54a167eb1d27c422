#pragma once

#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/pipeline/keyframe_graph.h"
#include "core/estimation/edge.h"
#include "core/geometry/rigid3.h"
#include "frontend/image/frame.h"
#include "frontend/image/view_samples.h"
#include "frontend/map/keyframe_map.h"
#include "frontend/map/stored_images.h"
#include "frontend/places/place_features.h"
#include "frontend/places/place_index.h"
#include "frontend/tracking/tracker.h"

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

// A frame that is to be a keyframe of the map.
struct NewKeyframe {
  int id = 0;               // another one for each
  Frame frame;              // its own images
  int segment = 0;          // of the odometry
  Rigid3d map_from_cam;     // where it is, if it has no edges
  std::vector<Edge> edges;  // to earlier keyframes, by id; it is `cur`
};

// A frame of the map, with its images.
struct FoundKeyframe {
  int id = 0;  // as in NewKeyframe
  Frame frame;
};

// What became of the map.
struct MapUpdate {
  std::map<int, Rigid3d> map_from_keyframe;  // of all there ever were
  std::map<int, int> segments;               // likewise
  int pairs = 0;                             // that were added
  int loops = 0;                             // of these
  int joined = 0;                            // segments that became one
  std::string trouble;  // why poses were not solved for; empty: they were
  double ms = 0.0;      // of work

  // An old keyframe that the view has come back to.
  std::optional<FoundKeyframe> returned_to;
};

// Joins keyframes to a map: pairs them with those that see the same (Tracker),
// found by their poses or by their looks (PlaceIndex), and keeps all poses in
// agreement (KeyframeGraph). For one thread.
class Mapper {
 public:
  // `tracker` makes pairs. Throws InputError for options that are not sound.
  Mapper(const MappingOptions& options, std::unique_ptr<Tracker> tracker);
  ~Mapper();

  // Begins with a map. `is_held`: its poses never move, and none makes way. To
  // be called first; several maps are segments that are joined where they meet.
  // Throws InputError for a map of another camera or one that is not sound.
  void Load(const KeyframeMap& map, bool is_held);

  // Takes a keyframe in.
  MapUpdate Add(NewKeyframe keyframe);

  // Looks for a lost frame in the whole map.
  std::optional<FoundKeyframe> Find(const Frame& lost);

  // Solves for all poses.
  MapUpdate Finish();

  // All keyframes that have not made way, and their pairs: as they were
  // measured, or `as_solved`, see KeyframeGraph::CovarianceAsSolved.
  KeyframeMap Map(bool as_solved = false) const;

  // By the places of its keyframes in Map(): see KeyframeGraph.
  std::vector<MotionMatrix> Covariances() const;
  const KeyframeGraph& graph() const { return graph_; }

 private:
  // By its number in graph_. Of those that made way only the id is kept.
  struct Keyframe {
    int id = 0;
    StoredImages images;
    ViewSamples samples;
    PlaceFeatures features;
  };
  // A motion between two segments that one pair alone speaks for.
  struct Meeting {
    int ref_segment = 0, cur_segment = 0;
    Rigid3d ref_from_cur;  // between their worlds
  };

  int AddKeyframe(int id, const Frame& frame, const Rigid3d& map_from_cam,
                  int segment, bool is_held);
  const Reference* ReferenceOf(int at);
  // How much of each of the two the other one sees, the less of both; 0 if one
  // sees it too much larger.
  double SharedView(int ref, int cur, const Rigid3d& cur_from_ref) const;
  std::vector<int> SeeingTheSame(int newest) const;
  // The motion from `ref` to a frame near a guess, if it is a good pair.
  std::optional<Edge> MakePair(int ref, int cur, const PreparedFrame& frame,
                               const Rigid3d& cur_from_ref_guess,
                               double min_inlier_share);
  void PairByPose(int newest, const PreparedFrame& frame, MapUpdate* update);
  void PairByLooks(int newest, const PreparedFrame& frame, MapUpdate* update);
  bool AgreesWithOthers(const Edge& edge, const PreparedFrame& frame);
  bool HaveMetBefore(const Edge& edge);
  void FindReturn(int newest, MapUpdate* update) const;
  void MakeWay(int newest);
  void Fill(MapUpdate* update) const;

  const MappingOptions options_;
  std::unique_ptr<Tracker> tracker_;
  KeyframeGraph graph_;
  std::vector<Keyframe> keyframes_;
  std::map<int, int> numbers_;  // of keyframes, by id
  PlaceIndex index_;
  std::vector<Meeting> meetings_;
  // References in use, the latest first.
  std::list<std::pair<int, std::unique_ptr<Reference>>> references_;
  Tracked tracked_;
};

}  // namespace rgbd_pose
