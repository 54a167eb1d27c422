#pragma once

#include <utility>
#include <vector>

#include "core/factors/blocks.h"
#include "core/factors/moving_pose.h"
#include "core/factors/sampler.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "costs/factors/shutter_match.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {

// Two frames with a rolling shutter, and what they see of a still scene.
template <typename Type>
struct ShutterScene {
  explicit ShutterScene(unsigned seed) : world(seed), random(seed) {
    ref = PoseFrom(world.Motion(2.0, 2.0));
    const Rigid3d motion = world.Motion(0.1, 0.3);
    cur = PoseFrom(Rigid3d(ref.q, ref.p) * motion.Inverse());
    twist_ref = random.template Vector<6>(1.0);
    twist_cur = random.template Vector<6>(1.0);
  }

  // A match whose rows are exposed up to `seconds` before or after the stamps.
  // A wrong one is anywhere in `cur`.
  ShutterMatchFactor<Type> Match(double seconds = 0.02, bool noise = false,
                                 bool is_wrong = false) {
    ShutterMatchFactor<Type> factor;
    factor.ref_seconds = random.Uniform(-seconds, seconds);
    factor.cur_seconds = random.Uniform(-seconds, seconds);
    const auto at_row = [](const PoseOf<double>& pose,
                           const MotionVector& twist, double after) {
      const PoseOf<double> later = PoseAfter(pose, twist, after);
      return Rigid3d(later.q, later.p);
    };
    const Rigid3d between =
        at_row(cur, twist_cur, factor.cur_seconds).Inverse() *
        at_row(ref, twist_ref, factor.ref_seconds);
    const MotionPrior prior = world.Prior(between, 0.3);
    Correspondences matches;
    // Epipolar lines are for matches without depth.
    do {
      matches = world.Matches(1, is_wrong ? 1.0 : 0.0, between, noise, 0.25);
    } while (!Type::Pack({matches, between, &prior}, 0,
                         factor.match.columns.data()));
    return factor;
  }

  // The poses and the twists, as the blocks of a factor.
  std::vector<std::vector<double>> Blocks() const {
    std::vector<std::vector<double>> blocks;
    for (const auto& [pose, twist] :
         {std::pair(ref, twist_ref), std::pair(cur, twist_cur)}) {
      const PoseVector x = PoseVectorOf(Rigid3d(pose.q, pose.p));
      blocks.emplace_back(x.data(), x.data() + x.size());
      blocks.emplace_back(twist.data(), twist.data() + twist.size());
    }
    return blocks;
  }

  RandomWorld world;
  FactorSampler random;
  PoseOf<double> ref, cur;  // world_from_cam
  MotionVector twist_ref, twist_cur;
};

}  // namespace rgbd_pose
