#pragma once

#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Keyframes of a camera that moves twice around the inside of a ring-shaped
// wall and looks at the wall: the input of an odometry, a pose graph and a
// bundle adjustment. Every keyframe observes about 200 landmarks, each once,
// with the noise of a Kinect. Pairs that share a keyframe share its noise, and
// no match is wrong, which suits bundle adjustment best.
struct SimulatedGraph {
  struct Sighting {
    int landmark = 0;
    Observation seen;
  };
  struct Pair {
    int ref = 0, cur = 0;
    Correspondences matches;
  };

  // focal_factor: assumed focal length, relative to the true one.
  SimulatedGraph(int keyframes, unsigned seed, double focal_factor = 1.0);

  // The estimated motions of all pairs. The first ones connect each keyframe
  // with the next.
  std::vector<RelativePose> Edges() const;

  Camera camera;  // as assumed
  std::vector<Rigid3d> truth;
  std::vector<std::vector<Sighting>>
      sightings;  // of each keyframe, by landmark
  int landmarks = 0;

  // Each keyframe with the previous one and up to 9 others that share at least
  // 40 landmarks: the oldest and the most recent.
  std::vector<Pair> pairs;
};

// Poses from consecutive pairs alone, with drift.
std::vector<Rigid3d> OdometryOf(const SimulatedGraph& graph,
                                const std::vector<RelativePose>& edges);

// Root mean square error (m) of the positions after the best rigid alignment.
double RmsError(const std::vector<Rigid3d>& poses,
                const std::vector<Rigid3d>& truth);

}  // namespace rgbd_pose
