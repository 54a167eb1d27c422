#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/frontend.h"
#include "frontend/image/depth_lookup.h"

namespace rgbd_pose {

// Corners of the reference frame, each found again by aligning small patches
// coarse to fine (patch_alignment.h), whatever the exposure. First both frames
// are aligned as a whole (coarse_alignment.h), so that every patch starts
// near, from a place that the images confirm; and patches are stretched and
// turned as depth, surface normal and motion have it.
class PatchFrontend final : public Frontend {
 public:
  static constexpr char kName[] = "patch";

  explicit PatchFrontend(const FrontendOptions& options);

  void Prepare(Frame* frame) const override;
  std::unique_ptr<FeatureSet> Detect(const Frame& frame) override;
  void Match(const FeatureSet& reference, const Frame& frame,
             const Rigid3d& cur_from_ref_guess,
             FeatureMatches* matches) override;

 private:
  FrontendOptions options_;
  DepthLookupOptions depth_options_;
  std::vector<cv::Mat> pyramid_;  // of a frame that has not been prepared
};

}  // namespace rgbd_pose
