#pragma once

#include <optional>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/initial_guess/consensus.h"
#include "frontend/features/descriptor_matching.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// What a frame is recognised by: ORB features (Rublee et al. 2011).
struct PlaceFeatures {
  DescribedKeypoints described;           // where, and what they look like
  std::vector<Observation> observations;  // of each keypoint
};

// Up to about 800, spread over the image and with a depth. Takes about 8 ms.
PlaceFeatures DescribeKeyframe(const Frame& frame, const Camera& camera,
                               const DepthLookupOptions& depth_options);

// What two frames share by their descriptors alone.
Correspondences MatchPlaces(const PlaceFeatures& prev, const PlaceFeatures& cur,
                            const Camera& camera);

// The motion between two frames without a guess, by random samples
// (core/initial_guess/consensus.h) of such matches: nothing unless more agree
// than chance brings about. Good enough to track from, not more. The same input
// gives the same bytes.
std::optional<Consensus> VerifyGeometrically(const Correspondences& matches);

}  // namespace rgbd_pose
