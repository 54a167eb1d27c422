#pragma once

#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"

namespace rgbd_pose {

// Keyframes of a camera that goes round the inside of a ring-shaped wall twice
// and looks at it: what an odometry, a graph of poses and a bundle adjustment
// each take of it. Every keyframe sees about 200 landmarks, each measured once,
// with the noise of a Kinect: pairs that share a keyframe share its noise, and
// no match is wrong, as is best for bundle adjustment.
struct SimulatedGraph {
  struct Sighting {
    int landmark = 0;
    Observation seen;
  };
  struct Pair {
    int ref = 0, cur = 0;
    Correspondences matches;
  };

  // What is measured is believed to be of a camera whose focal lengths are so
  // many times those it has.
  SimulatedGraph(int keyframes, unsigned seed, double focal_factor = 1.0);

  // The motions of all pairs by the estimator; the first ones lead from each
  // keyframe to the next.
  std::vector<RelativePose> Edges() const;

  Camera camera;  // as believed
  std::vector<Rigid3d> truth;
  std::vector<std::vector<Sighting>>
      sightings;  // by landmark, of each keyframe
  int landmarks = 0;

  // Each keyframe with the one before and up to 9 others that see at least 40
  // of the same landmarks: the oldest and the nearest.
  std::vector<Pair> pairs;
};

// Poses by the pairs of neighbours alone: they drift.
std::vector<Rigid3d> OdometryOf(const SimulatedGraph& graph,
                                const std::vector<RelativePose>& edges);

// Root mean square distance (m) of positions from the truth after the best
// rigid alignment.
double RmsError(const std::vector<Rigid3d>& poses,
                const std::vector<Rigid3d>& truth);

}  // namespace rgbd_pose
