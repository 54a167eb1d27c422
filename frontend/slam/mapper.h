#pragma once

#include <deque>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame_rectifier.h"
#include "frontend/frame/view_overlap.h"
#include "frontend/places/keyframe.h"
#include "frontend/places/place_database.h"
#include "frontend/slam/keyframe_graph.h"
#include "frontend/slam/keyframe_map.h"
#include "frontend/tracking/reference.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// The options of Mapper.
struct MappingOptions {
  // Maximum number of older keyframes that a new one is paired with by its
  // pose: half see most of its view, half, the oldest, limit the drift.
  int max_pairs = 8;

  // Two keyframes see the same if each shows this share of the other's view.
  double min_pair_share = 0.4;

  // Number of similar keyframes that are checked for showing the same place. 0:
  // loops are found only by pose, and segments are not joined.
  int max_loop_candidates = 4;

  // A keyframe is removed if an older one nearby sees this share of its view.
  double redundant_share = 0.85;

  // Number of latest keyframes whose poses are optimised at each keyframe,
  // together with those paired with the newest one. After a loop all are.
  int window = 10;

  // Maximum drift of a path relative to its length and rotation, as one
  // standard deviation. It limits the correction by a loop.
  double drift = 0.01;

  // A one-line description of an error in the options, or empty.
  std::string Check() const;
};

// The pose of a keyframe in the map.
struct KeyframePlace {
  Rigid3d map_from_cam;  // current estimate
  int segment = 0;       // `map` is the world frame of this segment
};

// Changes of the map.
struct MapUpdate {
  std::map<int, KeyframePlace> moved;  // by id, since the last update
  std::vector<MapEdge> links;          // new ones, by id
  int pairs = 0;                       // number of pairs added
  int loops = 0;                       // number of these that are loops
  int joined = 0;                      // number of segments merged
  std::string error;  // why optimising the poses failed, or empty
  double ms = 0.0;    // computing time

  // An old keyframe to whose view the camera has returned.
  std::optional<Keyframe> returned_to;
};

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
  std::optional<Keyframe> Find(const PreparedFrame& lost);

  // Says which way is up: KeyframeGraph::SetUp. Without effect for a keyframe
  // that was removed.
  void SetUp(const MapUp& up) {
    graph_.SetUp(numbers_.at(up.keyframe), {up.in_cam, up.sigma});
  }

  // Optimises all poses.
  MapUpdate Finish();

  // Turns and moves the worlds of all segments.
  MapUpdate MoveAll(const Rigid3d& moved_from_map);

  // All keyframes that were not removed, and their pairs. Covariances are as
  // measured, or `as_solved` by KeyframeGraph::CovarianceAsSolved.
  KeyframeMap Map(bool as_solved = false) const;

  // After Finish: covariances of the poses in the order of Map(), of [omega C],
  // relative to the first keyframe of the segment. Those of the graph and, on
  // top, what all pairs of a keyframe share: the error of its own timing. Empty
  // if they cannot be computed.
  std::vector<MotionMatrix> Covariances() const;

  // The poses and pairs of keyframes; covariances in the order of Map().
  const KeyframeGraph& graph() const { return graph_; }

 private:
  // A keyframe with compressed images. Removed ones have neither images nor
  // derived data. Pose and segment are in graph_.
  struct MappedKeyframe : Keyframe {
    std::optional<KeyframePlace> published;  // in the last MapUpdate
    ViewOverlap samples;                     // to compare views
  };

  // Compresses the images of a keyframe; returns its number in graph_.
  int AddKeyframe(Keyframe keyframe, const PreparedFrame& frame, bool is_held);
  void Index(int at);
  // The edge of two keyframes that graph_ knows by number.
  MapEdge ById(MapEdge numbered) const;
  Keyframe WithImages(int at) const;
  void FindReturn(int newest, MapUpdate* update) const;
  void CullKeyframes(int newest);
  void PublishMovedPoses(MapUpdate* update);

  // In keyframe_pairing.cc.
  void PairByPose(int newest, const PreparedFrame& frame);
  int CloseLoopsByAppearance(int newest, const PreparedFrame& frame);
  double SharedView(int ref, int cur, const Rigid3d& cur_from_ref) const;
  std::vector<int> SeeingTheSame(int newest) const;
  std::optional<RelativePose> MakePair(int ref, int cur,
                                       const PreparedFrame& frame,
                                       const Rigid3d& cur_from_ref_guess,
                                       double min_inlier_share);
  const Reference* ReferenceOf(int at);
  bool AgreesWithOthers(const RelativePose& edge, const PreparedFrame& frame);
  bool AreConnected(const RelativePose& edge);

  const MappingOptions options_;
  KeyframeGraph graph_;
  std::deque<MappedKeyframe> keyframes_;  // by number in graph_
  std::map<int, int> numbers_;            // by keyframe id
  PlaceDatabase index_;
  // Motions between the world frames of two segments, ref_from_cur, that only
  // one pair supports so far; by the segments of ref and cur.
  std::map<std::pair<int, int>, std::vector<Rigid3d>> meetings_;

  const std::unique_ptr<Tracker> tracker_;
  TrackingResult tracked_;
  FrameRectifier rectifier_;  // maps keep images of one moment
  // Those used last, the latest first, by number in graph_.
  std::list<std::pair<int, std::unique_ptr<Reference>>> references_;
};

}  // namespace rgbd_pose
