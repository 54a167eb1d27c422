#pragma once

#include <optional>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/initial_guess/consensus.h"
#include "frontend/features/descriptor_matching.h"
#include "frontend/features/frontend.h"
#include "frontend/frame/prepared_frame.h"

namespace rgbd_pose {

// The ORB features (Rublee et al. 2011) by which a frame is recognised.
struct PlaceFeatures {
  DescribedKeypoints described;           // keypoints with descriptors
  std::vector<Observation> observations;  // one per keypoint
};

// Up to about 800 features with depth, all over the image. Takes about 8 ms.
PlaceFeatures DescribeKeyframe(const PreparedFrame& frame,
                               const FrontendOptions& images);

// The motion between two frames whose descriptors match, by RANSAC
// (core/initial_guess/consensus.h) without an initial guess. Nothing unless
// more matches agree than by chance. Accurate enough only as an initial guess
// for tracking. The same input gives the same bytes.
std::optional<Consensus> VerifyGeometrically(const PlaceFeatures& prev,
                                             const PlaceFeatures& cur,
                                             const Camera& camera);

}  // namespace rgbd_pose
