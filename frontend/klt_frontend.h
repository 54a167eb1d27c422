#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/depth_lookup.h"
#include "frontend/frontend.h"

namespace rgbd_pose {

// Corners of the reference frame, tracked straight into each new frame by
// pyramidal Lucas-Kanade (Bouguet 2001), seeded by projecting their 3D points
// with the guess. Tracking always from the reference keeps tracks from
// drifting.
class KltFrontend final : public Frontend {
 public:
  static constexpr char kName[] = "klt";

  explicit KltFrontend(const FrontendOptions& options);

  std::string_view name() const override { return kName; }
  void Prepare(Frame* frame) const override;
  std::unique_ptr<FeatureSet> Detect(const Frame& frame) override;
  void Match(const FeatureSet& reference, const Frame& frame,
             const Rigid3d& cur_from_ref_guess,
             FeatureMatches* matches) override;

 private:
  FrontendOptions options_;
  DepthLookupOptions depth_options_;
  std::vector<cv::Mat> pyramid_;  // of a frame that has not been prepared
  std::vector<cv::Point2f> tracked_;
  std::vector<uchar> found_;
  std::vector<float> error_;
};

}  // namespace rgbd_pose
