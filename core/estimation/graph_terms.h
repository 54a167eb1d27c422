#pragma once

#include <ceres/loss_function.h>

#include <memory>
#include <vector>

#include "core/estimation/motion_cost.h"
#include "core/estimation/robust_terms.h"
#include "core/geometry/rigid3.h"

// What a MotionGraph holds, as its parts see it.

namespace rgbd_pose {

// Poses, by their numbers, and what is known of them.
struct GraphTerms {
  // The world as a pose, that priors are edges from.
  static constexpr int kWorld = 0;

  struct Pose {
    Rigid3d world_from_cam;
    bool is_fixed = false;
  };
  // A motion that was measured, or a prior.
  struct Edge {
    int ref = 0, cur = 0;
    Rigid3d cur_from_ref;
    MotionMatrix root;  // see SquareRootOf
    const ceres::LossFunction* loss = nullptr;
  };
  // A motion that is measured anew wherever the poses are.
  struct Live {
    int ref = 0, cur = 0;
    std::unique_ptr<RobustTerms> terms;
  };

  std::vector<Pose> poses = {{Rigid3d(), true}};
  std::vector<Edge> edges;
  std::vector<Live> live;

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
  double SquaredNorm(const Edge& edge) const;
};

}  // namespace rgbd_pose
