#pragma once

#include <vector>

#include "core/estimation/motion_estimate.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {

// Which features of a reference have a say in the motion. A robust loss follows
// the majority: while a reference from before a moving thing came into view is
// in use that is the scene; but of the features of a new reference most may lie
// on the moving thing. So where the last reference's features failed, new ones
// are only watched until they have agreed with the motion a few times.
class FeatureTrust {
 public:
  // All of so many features are trusted.
  explicit FeatureTrust(size_t features) : doubts_(features, 0) {}

  // The features of a new reference, doubted where those of the last one have
  // failed: `found`, `doubted` and `estimate` tell how the new reference's own
  // frame was tracked against the last one, and `missing_failed` whether
  // features that were not found count as failed. If that would leave fewer
  // than `min_trusted`, all are trusted.
  FeatureTrust(const FeatureSet& last, const FeatureMatches& found,
               const FeatureMatches& doubted, const MotionEstimate& estimate,
               bool missing_failed, const FeatureSet& fresh,
               size_t min_trusted);

  size_t num_trusted() const;

  // Moves the matches of doubted features from `found` to `doubted`.
  void Split(FeatureMatches* found, FeatureMatches* doubted) const;

  // Doubted matches that agree with the motion come nearer to being trusted,
  // others start anew.
  void Learn(const FeatureMatches& doubted, const Rigid3d& cur_from_ref);

 private:
  // Of each feature: how often it has to agree before it is trusted.
  std::vector<int> doubts_;
};

}  // namespace rgbd_pose
