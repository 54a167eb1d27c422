#pragma once

#include <vector>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/calibration_views.h"

namespace rgbd_pose {

// What is solved for, and how much a residual of each kind spreads in the
// sigmas that it came with.
struct CalibrationState {
  std::vector<Rigid3d> world_from_cam;  // of keyframes
  std::vector<double> inverse_depths;   // of landmarks at their anchors
  CalibrationVector theta;
  double pixel_scale = 1.0;
  double depth_scale = 1.0;
};

// The poses of a state's keyframes (cam from world) and their derivatives by a
// motion that is added to them, where it is zero.
std::vector<MotionDerivatives> PosesOf(const CalibrationState& state);

// When a row (px) of a keyframe was exposed.
RowMotion MotionAt(const CalibrationViews& views, int keyframe, double row);

// What is measured of a landmark in one view, its sigmas as a state has them.
LandmarkData DataOf(const CalibrationViews& views, const Landmark& landmark,
                    const LandmarkView& view, const CalibrationState& state);

// The same at its anchor.
LandmarkData DataOf(const CalibrationViews& views, const Landmark& landmark,
                    const CalibrationState& state);

}  // namespace rgbd_pose
