#pragma once

#include <memory>

#include "frontend/features/descriptor_matching.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {

// The frontends of MakeFrontend, which checks the options.

// Tracks corners with pyramidal Lucas-Kanade (Bouguet 2001), always from the
// reference, which prevents drift.
std::unique_ptr<Frontend> MakeKltFrontend(const FrontendOptions& options);

// Finds corners by aligning small patches coarse to fine (patch.h), warped
// according to depth, surface normal and motion, from a start within some
// pixels (see DirectTracker::FindStart).
std::unique_ptr<Frontend> MakePatchFrontend(const FrontendOptions& options);

// Detects keypoints in every frame and matches them by their descriptors: first
// near the places predicted by the guess, anywhere if too few are found there.
// This is slower than tracking corners, but it needs no good guess and
// tolerates larger changes of scale and view. `method` must outlive it.
std::unique_ptr<Frontend> MakeDescriptorFrontend(
    const FrontendOptions& options, const DescriptorMethod& method);

}  // namespace rgbd_pose
