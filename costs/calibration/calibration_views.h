#pragma once

#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/landmark_residuals.h"

namespace rgbd_pose {

// A landmark as another keyframe than its anchor sees it.
struct LandmarkView {
  int keyframe = 0;
  double u = 0.0, v = 0.0;     // px, as seen (distorted)
  double sigma_px = 0.5;       // of u and v
  MeasuredInverseDepth depth;  // there, if any
  bool is_held_out = false;    // kept to judge by

  // In a solution of what is not held out, or of all.
  bool TakesPart(bool training_only) const {
    return !(training_only && is_held_out);
  }
};

// A point on the ray of a pixel of a keyframe.
struct Landmark {
  int anchor = 0;              // its keyframe
  double u = 0.0, v = 0.0;     // px, as seen (distorted)
  MeasuredInverseDepth depth;  // there
  int first_view = 0;          // of CalibrationViews::views
  int num_views = 0;
};

// How far apart two places of the camera are, as something else gives it: what
// gives images a scale. The places are at `in_a` and `in_b` in the axes of two
// keyframes, as measured (times kDepthFactor).
struct KnownDistance {
  int a = 0, b = 0;  // keyframes
  Eigen::Vector3d in_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d in_b = Eigen::Vector3d::Zero();
  double metres = 0.0;
  double sigma = 0.01;  // m
};

// All that a camera is calibrated from.
struct CalibrationViews {
  Camera camera;                        // to begin with
  std::vector<Rigid3d> world_from_cam;  // of keyframes, as far as known
  std::vector<Twist> twists;            // of each of them
  std::vector<Landmark> landmarks;
  std::vector<LandmarkView> views;       // of each landmark in a row
  std::vector<KnownDistance> distances;  // may be empty: then there is no scale
};

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
