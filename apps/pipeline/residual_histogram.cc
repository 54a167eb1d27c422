#include "apps/pipeline/residual_histogram.h"

#include <algorithm>

namespace rgbd_pose {

void ResidualHistogram::Add(const MotionEstimate& estimate) {
  for (size_t i = 0; i < estimate.residual_norms.size(); ++i) {
    const int count = estimate.residual_degrees[i];
    if (count == 0) continue;
    ++matches;
    ++degrees[std::min<size_t>(count, degrees.size() - 1)];
    // Compared as numbers: a huge norm does not fit into a place.
    const double place = estimate.residual_norms[i] / kNormBin;
    if (place < norms.size()) {
      ++norms[static_cast<size_t>(place)];
    } else {
      ++norms_above;
    }
    const double weight = estimate.weights[i];
    weights_zero += weight == 0.0;
    ++weights[std::min(static_cast<size_t>(weight / kWeightBin),
                       weights.size() - 1)];
  }
}

}  // namespace rgbd_pose
