#pragma once

#include <ceres/loss_function.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/estimation/edge.h"
#include "core/estimation/motion_graph.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// How keyframes are held together.
struct KeyframeGraphOptions {
  // Poses of the latest keyframes, and of those that the newest is paired with,
  // are solved for at each keyframe; after a loop all are.
  int window = 10;

  // What noise models do not know (calibration, stamps): at least so much is a
  // pair off.
  double min_sigma_rotation = 2e-4;     // rad
  double min_sigma_translation = 5e-4;  // m

  // By what share of the way and of the turns a path drifts at most, as one
  // standard deviation: what a loop may correct.
  double drift = 0.01;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Poses of keyframes and the motions measured between them. Keyframes have
// numbers 0, 1, 2, ... Poses of one segment hang together; each segment has a
// world of its own until it is joined to another. The first keyframe of a
// segment stays where it is.
class KeyframeGraph {
 public:
  // A measured motion between two keyframes.
  struct Pair {
    Edge edge;                // between numbers
    bool is_tracked = false;  // by the odometry; hardly ever wrong
    bool is_loop = false;     // joins what was far apart
  };

  // Throws InputError for options that are not sound (see Check).
  explicit KeyframeGraph(const KeyframeGraphOptions& options);

  // How many there are, those that were dropped among them.
  int size() const { return static_cast<int>(nodes_.size()); }
  // Of one: map_from_cam, its segment, all pairs, and those it is paired with.
  const Rigid3d& pose(int at) const { return nodes_[at].map_from_cam; }
  int segment(int at) const { return nodes_[at].segment; }
  const std::vector<Pair>& pairs() const { return pairs_; }
  const std::vector<int>& neighbours(int at) const {
    return nodes_[at].neighbours;
  }
  // Whether a pair joins the two.
  bool AreJoined(int a, int b) const;

  // Returns its number. `is_held`: it never moves (a map that is only read).
  int Add(const Rigid3d& map_from_cam, int segment, bool is_held = false);

  // Within a segment.
  void AddPair(const Edge& edge, bool is_tracked, bool is_loop = false);

  // Whether each keyframe is within so many pairs of one.
  std::vector<bool> Within(int from, int hops) const;

  // The number of pairs on the shortest way between two, at most `most`.
  int Hops(int from, int to, int most) const;

  // Whether a motion may be right, as far as the way between the two by other
  // pairs tells: chi^2 of 6 degrees below its 99.9 % quantile.
  bool IsPlausible(const Edge& edge) const;

  // Moves a whole segment to where an edge, from another one to it, says; from
  // then on both are the other one.
  void Join(const Edge& edge);

  // Whether all others would still hang together without it.
  bool CanDoWithout(int at) const;
  // Takes a keyframe and its pairs out: from now on it stands where it stood to
  // `anchor`.
  void Drop(int at, int anchor);
  bool IsDropped(int at) const { return nodes_[at].anchor >= 0; }
  // For a motion measured to a keyframe that was dropped: the same to its
  // anchor; others are given back as they are.
  Edge Anchored(Edge edge) const;

  // Solves for the poses around the newest keyframe, or for all. Why it could
  // not, or empty.
  std::string SolveNear(int newest);
  std::string SolveAll(bool graduated);

  // Covariances of all poses after SolveAll, as MotionGraph has them, times its
  // redundancy: zero for those that do not move, empty if they cannot be told.
  std::vector<MotionMatrix> Covariances() const;

  // The covariance with which a pair counts at the present poses: with its
  // floor and the slack, and larger the less its loss lets it count. Whoever
  // solves for the poses by least squares with these finds what is here.
  MotionMatrix CovarianceAsSolved(const Pair& pair) const;

  // By what share of itself a motion is off beyond its covariance, as the pairs
  // disagree: 0 where the camera is as its calibration says.
  double slack() const { return slack_; }

 private:
  struct Node {
    Rigid3d map_from_cam;
    int segment = 0;
    bool is_held = false;
    std::vector<int> neighbours;
    int anchor = -1;  // if it was dropped
    Edge from_anchor;
  };
  struct Problem;

  bool IsFixed(int at) const;
  MotionMatrix CovarianceOf(const Edge& edge, double slack) const;
  double FindSlack() const;
  Problem Build(const std::vector<int>& free, bool graduated) const;
  std::string Solve(const std::vector<int>& free, bool graduated);
  std::vector<int> All() const;
  void FollowAnchors();

  const KeyframeGraphOptions options_;
  std::unique_ptr<ceres::LossFunction> tracked_loss_, pair_loss_;
  std::vector<Node> nodes_;
  std::vector<Pair> pairs_;
  std::map<int, int> first_of_;  // of each segment
  double slack_ = 0.0;
};

}  // namespace rgbd_pose
