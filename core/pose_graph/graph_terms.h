#pragma once

#include <ceres/loss_function.h>

#include <vector>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"

// What a PoseGraph holds, as its parts see it.

namespace rgbd_pose {

// Poses, by their numbers, and what is known of them.
struct GraphTerms {
  struct Pose {
    Rigid3d world_from_cam;
    bool is_fixed = false;
  };
  // A motion that was measured.
  struct Edge {
    int ref = 0, cur = 0;
    Rigid3d cur_from_ref;
    MotionMatrix root;  // see SqrtInformation
    const ceres::LossFunction* loss = nullptr;
  };
  std::vector<Pose> poses;
  std::vector<Edge> edges;

  // cur_from_ref as the poses have it.
  Rigid3d Between(int ref, int cur) const {
    return poses[cur].world_from_cam.Inverse() * poses[ref].world_from_cam;
  }

  // Whether there is such a pose.
  bool Has(int pose) const {
    return pose >= 0 && pose < static_cast<int>(poses.size());
  }

  // Whether what is between the two changes nothing.
  bool IsIdle(int ref, int cur) const {
    return poses[ref].is_fixed && poses[cur].is_fixed;
  }

  // By how many sigmas, squared, an edge disagrees with the poses.
  double SquaredMahalanobisDistance(const Edge& edge) const;
};

}  // namespace rgbd_pose
