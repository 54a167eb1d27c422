#pragma once

#include "core/estimation/frame_view.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"

namespace rgbd_pose {

// Whether match `i` is where the motion puts it (within 2 px: 3 sigmas of
// 0.7 px).
bool AgreesWithMotion(const FeatureMatches& found, size_t i,
                      const Rigid3d& cur_from_ref);

// The part of the image (cells of 64 px) in which matches agree: the scene is
// seen in more of it than what moves by itself, which may have more features.
int CellsOfInliers(const FeatureMatches& found, const MotionEstimate& estimate);

// Where in the current image more features contradict the motion than agree;
// `missing_contradict`: those that were not found, too, a little. Returns in
// which share of the image, as far as there are features, some agree.
double MarkMoving(const FeatureSet& reference, const FeatureMatches& found,
                  const FeatureMatches& on_probation,
                  const MotionEstimate& estimate, bool missing_contradict,
                  CellMask* moving);

}  // namespace rgbd_pose
