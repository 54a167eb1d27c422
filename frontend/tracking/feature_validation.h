#pragma once

#include <vector>

#include "core/estimation/motion_estimate.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {

// Which features of a reference have a say in the motion. A robust loss follows
// the majority: while a reference from before a moving thing came into view is
// in use that is the scene; but of the features of a new reference most may lie
// on the moving thing. So where the last reference's features failed, new ones
// are only watched until they have agreed with the motion a few times.
class FeatureValidation {
 public:
  // All of so many features are trusted.
  explicit FeatureValidation(size_t features)
      : agreements_needed_(features, 0) {}

  // The features of a new reference, on probation where those of the last one
  // have failed. `found`, `on_probation` and `estimate` are how the new
  // reference's own frame was tracked against the last one, `missing_failed`:
  // features that were not found count as failed. If that would leave fewer
  // than `min_trusted`, all are trusted.
  FeatureValidation(const FeatureSet& last, const FeatureMatches& found,
                    const FeatureMatches& on_probation,
                    const MotionEstimate& estimate, bool missing_failed,
                    const FeatureSet& fresh, size_t min_trusted);

  size_t num_trusted() const;

  // Moves the matches of features on probation from `found` to `on_probation`.
  void Split(FeatureMatches* found, FeatureMatches* on_probation) const;

  // Matches on probation that agree with the motion come nearer to being
  // trusted, others begin again.
  void Learn(const FeatureMatches& on_probation, const Rigid3d& cur_from_ref);

 private:
  // Of each feature: how often it has to agree before it is trusted.
  std::vector<int> agreements_needed_;
};

}  // namespace rgbd_pose
