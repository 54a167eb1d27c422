#include "apps/results/residual_histogram.h"

#include <algorithm>

namespace rgbd_pose {

void ResidualHistogram::Add(const MotionEstimate& estimate) {
  for (size_t i = 0; i < estimate.residual_norms.size(); ++i) {
    const int degrees = estimate.residual_degrees[i];
    if (degrees == 0) continue;
    ++matches_;
    ++degrees_[std::min<size_t>(degrees, degrees_.size() - 1)];
    // Compared as numbers: a huge norm does not fit into a place.
    const double place = estimate.residual_norms[i] / kNormBin;
    if (place < norms_.size()) {
      ++norms_[static_cast<size_t>(place)];
    } else {
      ++norms_above_;
    }
    const double weight = estimate.weights[i];
    weights_zero_ += weight == 0.0;
    ++weights_[std::min(static_cast<size_t>(weight / kWeightBin),
                        weights_.size() - 1)];
  }
}

nlohmann::json ResidualHistogram::ToJson() const {
  return {{"matches", matches_},           {"norm_bin", kNormBin},
          {"norm_counts", norms_},         {"norms_above", norms_above_},
          {"weight_bin", kWeightBin},      {"weight_counts", weights_},
          {"weights_zero", weights_zero_}, {"degrees_counts", degrees_}};
}

}  // namespace rgbd_pose
