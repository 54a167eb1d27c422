#pragma once

#include <vector>

#include "core/estimation/motion_estimate.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {

// Decides which features of a reference may affect the motion. A robust loss
// follows the majority. With a reference older than the appearance of a moving
// object, the majority is the scene; of a new reference, most features may lie
// on the moving object. Where features of the last reference failed, new ones
// are thus only observed until they have agreed with the motion a few times.
class FeatureValidation {
 public:
  // Trusts all of the given number of features.
  explicit FeatureValidation(size_t features)
      : agreements_needed_(features, 0) {}

  // Puts features of a new reference on probation where those of the last one
  // have failed. `found`, `on_probation` and `estimate` are the result of
  // tracking the frame of the new reference against the last one.
  // `missing_failed`: features that were not found count as failed. If fewer
  // than `min_trusted` features would be trusted, all are.
  FeatureValidation(const FeatureSet& last, const FeatureMatches& found,
                    const FeatureMatches& on_probation,
                    const MotionEstimate& estimate, bool missing_failed,
                    const FeatureSet& fresh, size_t min_trusted);

  size_t num_trusted() const;

  // Moves the matches of features on probation from `found` to `on_probation`.
  void Split(FeatureMatches* found, FeatureMatches* on_probation) const;

  // Counts agreements: a feature on probation that agrees with the motion comes
  // closer to being trusted, others start from the beginning.
  void Learn(const FeatureMatches& on_probation, const Rigid3d& cur_from_ref);

 private:
  // How often each feature still has to agree before it is trusted.
  std::vector<int> agreements_needed_;
};

}  // namespace rgbd_pose
