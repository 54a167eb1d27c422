#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "frontend/features/descriptor_matching.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {

// Detects keypoints in every frame and matches them by their descriptors: first
// near the places predicted by the guess, anywhere if too few are found there.
// This is slower than tracking corners, but it needs no good guess and
// tolerates larger changes of scale and view.
class DescriptorFrontend final : public Frontend {
 public:
  // `method` must outlive the frontend.
  DescriptorFrontend(const FrontendOptions& options,
                     const DescriptorMethod& method)
      : Frontend(options), method_(method) {}

  bool is_exhaustive() const override { return false; }
  void Prepare(const PreparedFrame& frame) const override;
  std::unique_ptr<FeatureSet> Detect(const PreparedFrame& frame) override;
  void Match(const FeatureSet& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_guess,
             FeatureMatches* matches) override;

 private:
  const DescribedKeypoints& Keypoints(const PreparedFrame& frame) const;
  Observation ObserveKeypoint(const Frame& frame,
                              const cv::KeyPoint& keypoint) const;

  const DescriptorMethod& method_;
};

}  // namespace rgbd_pose
