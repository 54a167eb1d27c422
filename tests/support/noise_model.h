#pragma once

#include "core/estimation/correspondences.h"

namespace rgbd_pose {

// The same matches with all sigmas of the noise model multiplied by `factor`.
inline Correspondences WithSigmas(const Correspondences& matches,
                                  double factor) {
  Correspondences result(matches.camera());
  for (Match match : matches) {
    for (Observation* o : {&match.prev, &match.cur}) {
      o->sigma_px *= factor;
      o->sigma_depth *= factor;
    }
    result.Add(match.prev, match.cur);
  }
  return result;
}

}  // namespace rgbd_pose
