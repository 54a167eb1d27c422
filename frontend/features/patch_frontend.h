#pragma once

#include "frontend/features/frontend.h"

namespace rgbd_pose {

// Corners of the reference frame, each found again by aligning small patches
// coarse to fine (patch.h), whatever the exposure, from within some
// pixels (see DirectTracker::FindStart). Patches are stretched and turned as
// depth, surface normal and motion have it.
class PatchFrontend final : public Frontend {
 public:
  static constexpr char kName[] = "patch";

  using Frontend::Frontend;

  void Prepare(const PreparedFrame& frame) const override;
  std::unique_ptr<FeatureSet> Detect(const PreparedFrame& frame) override;
  void Match(const FeatureSet& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_guess,
             FeatureMatches* matches) override;
};

}  // namespace rgbd_pose
