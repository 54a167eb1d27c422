#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/pose_graph/pose_graph.h"
#include "core/pose_graph/relative_pose.h"
#include "frontend/mapping/covisibility_graph.h"
#include "frontend/mapping/edge_noise_model.h"

namespace rgbd_pose {

// Poses of keyframes and the motions measured between them. Keyframes have
// numbers 0, 1, 2, ... Poses of one segment hang together; each segment has a
// world of its own until it is joined to another. The first keyframe of a
// segment stays where it is.
class KeyframeGraph {
 public:
  // See MappingOptions.
  KeyframeGraph(int window, double drift) : window_(window), noise_(drift) {}

  // How many there are, those that were dropped among them.
  int size() const { return static_cast<int>(nodes_.size()); }
  // Of one: map_from_cam, its segment.
  const Rigid3d& pose(int at) const { return nodes_[at].map_from_cam; }
  int segment(int at) const { return nodes_[at].segment; }
  // All pairs, and who is joined to whom by them.
  const std::vector<KeyframePair>& pairs() const { return pairs_; }
  const CovisibilityGraph& links() const { return links_; }

  // Returns its number. `is_held`: it never moves (a map that is only read).
  int Add(const Rigid3d& map_from_cam, int segment, bool is_held = false);

  // Within a segment.
  void AddPair(const RelativePose& edge, bool is_tracked, bool is_loop = false);

  // Whether a motion may be right, as far as the way between the two by other
  // pairs says: chi^2 of 6 degrees below its 99.9 % quantile.
  bool PassesMahalanobisGate(const RelativePose& edge) const;

  // Moves a whole segment to where an edge between it and another one says;
  // from then on both are the other one. Of the two the one with `edge.cur`
  // moves, but never one that is held. False, and nothing is done, if both are.
  bool Join(const RelativePose& edge);

  // Whether all others would still hang together without it.
  bool IsRedundant(int at) const;
  // Takes a keyframe and its pairs out: from now on it stands where it stood to
  // `anchor`.
  void Remove(int at, int anchor);
  bool IsRemoved(int at) const { return nodes_[at].anchor >= 0; }
  // For a motion measured to a keyframe that was dropped: the same to its
  // anchor; others are given back as they are.
  RelativePose Reanchor(RelativePose edge) const;

  // Solves for the poses around the newest keyframe, or for all, wherever they
  // are. Why it could not, or empty.
  std::string SolveNear(int newest);
  std::string SolveAll();

  // Covariances of all poses after SolveAll, as PoseGraph has them, times its
  // redundancy: zero for those that do not move, empty if they cannot be
  // computed.
  std::vector<MotionMatrix> Covariances() const;

  // The covariance with which a pair counts at the present poses: with its
  // floor and the proportional error, and larger the less its loss lets it
  // count. Whoever solves for the poses by least squares with these finds what
  // is here.
  MotionMatrix CovarianceAsSolved(const KeyframePair& pair) const;

  // See EdgeNoiseModel.
  double proportional_error() const { return noise_.proportional_error(); }

 private:
  struct Node {
    Rigid3d map_from_cam;
    int segment = 0;
    bool is_held = false;
    int anchor = -1;  // if it was dropped
    RelativePose from_anchor;
  };
  struct Problem;

  bool IsFixed(int at) const;
  bool IsHeld(int segment) const;
  // cur_from_ref as the poses have it.
  Rigid3d MotionOf(const RelativePose& edge) const;
  void FitProportionalError();
  Problem Build(const std::vector<int>& free, bool graduated) const;
  std::string Solve(const std::vector<int>& free, bool graduated);
  std::vector<int> All() const;
  void FollowAnchors();

  const int window_;
  EdgeNoiseModel noise_;
  std::vector<Node> nodes_;
  CovisibilityGraph links_;
  std::vector<KeyframePair> pairs_;
  std::map<int, int> first_of_;  // of each segment
};

}  // namespace rgbd_pose
