#pragma once

#include <ceres/loss_function.h>

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/pose_graph/pose_graph.h"
#include "frontend/slam/map_edge.h"

namespace rgbd_pose {

// Which keyframes are linked by pairs, regardless of the measured motions.
// Keyframes have numbers 0, 1, 2, ...
class CovisibilityGraph {
 public:
  // Adds a keyframe without links.
  void Add() { neighbors_.emplace_back(); }
  void Join(int a, int b);
  // Removes all links of a keyframe.
  void Separate(int at);

  // The keyframes that a keyframe is linked to.
  const std::vector<int>& Neighbors(int at) const { return neighbors_[at]; }
  bool AreJoined(int a, int b) const;

  // For each keyframe whether it is within `hops` links of `from`.
  std::vector<bool> Within(int from, int hops) const;

  // A path with the fewest links, including both ends; empty if there is none.
  std::vector<int> ShortestPath(int from, int to) const;

  // For each keyframe the smallest number in its connected component.
  std::vector<int> FirstOfParts() const;

  // Whether the neighbours of a keyframe are near each other without it.
  bool StaysConnectedWithout(int at) const;

 private:
  // Searches breadth first, up to `hops` links away, but not through keyframes
  // with an entry in `before` (-1: none). Returns the keyframes reached and
  // enters for each the one it was reached from.
  std::vector<int> Reach(int from, std::vector<int>* before,
                         int hops = std::numeric_limits<int>::max()) const;

  std::vector<std::vector<int>> neighbors_;
};

// Poses of keyframes 0, 1, 2, ... and the motions measured between them. The
// poses of a segment are connected; each segment has its own world frame until
// it is joined to another one. The first keyframe of a segment is fixed.
class KeyframeGraph {
 public:
  // See MappingOptions.
  KeyframeGraph(int window, double drift);

  // Number of keyframes, including removed ones.
  int size() const { return static_cast<int>(nodes_.size()); }
  // map_from_cam and the segment of a keyframe.
  const Rigid3d& pose(int at) const { return nodes_[at].map_from_cam; }
  int segment(int at) const { return nodes_[at].segment; }
  // The first keyframe of its segment. It is fixed, as are those that are held.
  int FirstOf(int at) const { return first_of_.at(segment(at)); }
  bool IsFixed(int at) const { return IsHeld(at) || FirstOf(at) == at; }
  bool IsHeld(int at) const { return nodes_[at].is_held; }
  // The motion between two keyframes by their current poses.
  Rigid3d CurFromRef(int ref, int cur) const {
    return pose(cur).Inverse() * pose(ref);
  }
  // All pairs, and the links that they form.
  const std::vector<MapEdge>& pairs() const { return pairs_; }
  const CovisibilityGraph& links() const { return links_; }

  // Adds a keyframe and returns its number. With `is_held` it never moves.
  int Add(const Rigid3d& map_from_cam, int segment, bool is_held = false);

  // Adds a pair within a segment.
  void AddPair(const RelativePose& edge, bool is_tracked, bool is_loop = false);

  // Which way is up in the axes of a keyframe.
  struct Up {
    Eigen::Vector3d in_cam;  // of length 1
    double sigma = 0.0;      // of its angle, rad
  };

  // Says which way is up: the tilt of the keyframe in the world is measured
  // then. Which way is up in the world of a segment is estimated with the
  // poses.
  void SetUp(int at, const Up& up) { nodes_[at].up = up; }
  const std::optional<Up>& up(int at) const { return nodes_[at].up; }

  // Whether a motion is consistent with a path of other pairs: chi^2 with 6
  // degrees of freedom is below its 99.9 % quantile. False without a path.
  bool PassesMahalanobisGate(const RelativePose& edge) const;

  // Merges two segments by an edge between them: one is moved and becomes part
  // of the other. The segment of `edge.cur` moves, unless it is held; then the
  // other one moves. Returns false and changes nothing if both are held.
  bool Join(const RelativePose& edge);

  // Whether a keyframe is not fixed and the others stay connected without it.
  bool IsRedundant(int at) const;
  // Removes a keyframe and its pairs. From now on it moves with `anchor`.
  void Remove(int at, int anchor);
  bool IsRemoved(int at) const { return nodes_[at].from_anchor.has_value(); }
  // Converts a motion from a removed keyframe to one from its anchor. Other
  // motions are returned unchanged.
  RelativePose Reanchor(RelativePose edge) const;

  // Turns and moves the worlds of all segments.
  void MoveAll(const Rigid3d& moved_from_map) {
    for (Node& node : nodes_) {
      node.map_from_cam = moved_from_map * node.map_from_cam;
    }
  }

  // Optimise the poses around the newest keyframe, or all poses. Return the
  // reason of a failure, or an empty string.
  std::string SolveNear(int newest);
  std::string SolveAll();

  // Covariances of all poses after SolveAll, without removed keyframes: those
  // of PoseGraph times its OvercountingFactor. Zero for fixed poses; empty if
  // they cannot be computed.
  std::vector<MotionMatrix> Covariances() const;

  // The effective covariance of a pair at the current poses: larger if the loss
  // reduces its weight. Least squares with these gives the same poses.
  MotionMatrix CovarianceAsSolved(const MapEdge& pair) const;

  // The error relative to the motion that explains the disagreement of pairs
  // beyond their covariances. 0 if the calibration is accurate.
  double proportional_error() const { return proportional_error_; }

 private:
  struct Node {
    Rigid3d map_from_cam;
    int segment = 0;
    bool is_held = false;
    std::optional<RelativePose> from_anchor;  // of a removed keyframe
    std::optional<Up> up = {};
  };
  struct Problem;

  Problem Build(const std::vector<int>& free, bool graduated) const;
  void AddUps(const std::vector<bool>& is_free, Problem* problem) const;
  std::string Solve(const std::vector<int>& free, bool graduated);
  std::vector<int> All() const;

  // In keyframe_noise.cc. The covariance with noise floor and proportional
  // error, and as it counts in the graph; the squared distance of an edge from
  // the current poses, in sigmas.
  MotionMatrix CovarianceOf(const RelativePose& edge) const;
  MotionMatrix CovarianceInGraph(const MapEdge& pair) const;
  double SquaredDistance(const RelativePose& edge,
                         const MotionMatrix& covariance) const;
  const ceres::LossFunction* LossOf(const MapEdge& pair) const {
    return pair.is_tracked ? tracked_loss_.get() : pair_loss_.get();
  }
  void FitProportionalError();

  const int window_;
  const double drift_;
  const std::unique_ptr<ceres::LossFunction> tracked_loss_, pair_loss_;
  double proportional_error_ = 0.0;
  std::vector<Node> nodes_;
  CovisibilityGraph links_;
  std::vector<MapEdge> pairs_;
  std::map<int, int> first_of_;  // first keyframe by segment
};

}  // namespace rgbd_pose
