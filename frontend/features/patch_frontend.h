#pragma once

#include "frontend/features/frontend.h"

namespace rgbd_pose {

// Finds each corner of the reference frame by aligning small patches coarse to
// fine (patch.h), independently of the exposure, from a start within some
// pixels (see DirectTracker::FindStart). Patches are warped according to depth,
// surface normal and motion.
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
