#pragma once

#include "core/geometry/motion.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {

// A random motion and a match (or prior) that a residual type can use, to
// evaluate it at: what tests, benchmarks and rgbd_jacobians look at.
template <typename Residual>
struct ResidualSample {
  LinearizationPoint origin;
  MotionVector x;
  double columns[Residual::kColumns];

  explicit ResidualSample(RandomWorld* world) {
    // Enough lack a depth on one side for costs that use those matches.
    constexpr double kMissingDepthShare = 0.25;
    origin = LinearizationPoint(world->Motion(1.0, 1.0));
    x << world->Vector(0.7), world->Vector(0.7);
    const Rigid3d motion = origin.CurFromPrev(x.data());
    const MotionPrior prior = world->Prior(motion, 0.3);
    while (true) {
      const Correspondences matches =
          world->Matches(1, 0.0, motion, /*noise=*/true, kMissingDepthShare);
      if (Residual::Pack({matches, motion, &prior}, 0, columns)) return;
    }
  }
};

}  // namespace rgbd_pose
