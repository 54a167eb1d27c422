#pragma once

#include "core/estimation/frame_view.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {

// Whether match `i` is within 2 px of its prediction (3 sigmas of 0.7 px).
bool AgreesWithMotion(const FeatureMatches& found, size_t i,
                      const Rigid3d& cur_from_ref);

// Returns the number of image cells (64 px) that contain inliers. The scene
// covers more cells than a moving object, even if the object has more features.
int CellsOfInliers(const FeatureMatches& found, const MotionEstimate& estimate);

// Marks where in the current image more features contradict the motion than
// agree; `missing_contradict`: features not found contradict it a little, too.
// Returns in which share of the regions with features some features agree.
double MarkMoving(const FeatureSet& reference, const FeatureMatches& found,
                  const FeatureMatches& on_probation,
                  const MotionEstimate& estimate, bool missing_contradict,
                  CellMask* moving);

}  // namespace rgbd_pose
