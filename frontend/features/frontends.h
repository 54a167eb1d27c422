#pragma once

#include <memory>

#include "frontend/features/descriptor_matching.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {

// The frontends of MakeFrontend, which checks the options.

// Tracks corners of the reference frame directly into each new frame with
// pyramidal Lucas-Kanade (Bouguet 2001), starting at their 3D points projected
// with the guess. Tracking always from the reference prevents drift.
std::unique_ptr<Frontend> MakeKltFrontend(const FrontendOptions& options);

// Finds each corner of the reference frame by aligning small patches coarse to
// fine (patch.h), independently of the exposure, from a start within some
// pixels (see DirectTracker::FindStart). Patches are warped according to depth,
// surface normal and motion.
std::unique_ptr<Frontend> MakePatchFrontend(const FrontendOptions& options);

// Detects keypoints in every frame and matches them by their descriptors: first
// near the places predicted by the guess, anywhere if too few are found there.
// This is slower than tracking corners, but it needs no good guess and
// tolerates larger changes of scale and view. `method` must outlive it.
std::unique_ptr<Frontend> MakeDescriptorFrontend(
    const FrontendOptions& options, const DescriptorMethod& method);

}  // namespace rgbd_pose
