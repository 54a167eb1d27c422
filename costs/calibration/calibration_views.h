#pragma once

#include <memory>
#include <vector>

#include "core/factors/blocks.h"
#include "core/factors/distance.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/twist.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/landmark_data.h"

namespace rgbd_pose {

// A pixel of a keyframe and the inverse depth measured there.
struct DepthPixel {
  double u = 0.0, v = 0.0;  // px, as seen (distorted)
  MeasuredInverseDepth depth;
};

// An observation of a landmark in a keyframe other than its anchor.
struct LandmarkView : DepthPixel {
  int keyframe = 0;
  double sigma_px = 0.5;     // of u and v
  bool is_held_out = false;  // kept for validation

  // Whether the view is used; with training_only, held-out views are not.
  bool TakesPart(bool training_only) const {
    return !(training_only && is_held_out);
  }
};

// A point on the viewing ray of a pixel of a keyframe, its anchor.
struct Landmark : DepthPixel {
  int anchor = 0;      // the keyframe
  int first_view = 0;  // of CalibrationViews::views
  int num_views = 0;
};

// A distance between two positions of the camera, known from another source; it
// gives the images a scale. The positions are in the axes of keyframes a and b,
// as measured (kDepthFactor scales them to metres).
struct KnownDistance : DistanceFactor {
  int a = 0, b = 0;  // keyframes
};

// The input of a calibration.
struct CalibrationViews {
  Camera camera;                        // initial guess
  std::vector<Rigid3d> world_from_cam;  // of keyframes, initial guess
  std::vector<Twist> twists;            // of keyframes
  std::vector<Landmark> landmarks;
  std::vector<LandmarkView> views;       // grouped by landmark
  std::vector<KnownDistance> distances;  // if empty, the scale is unknown
};

// The unknowns, and the scale of each kind of residual: its spread relative to
// the sigmas of the measurements.
struct CalibrationState {
  std::vector<Rigid3d> world_from_cam;  // of keyframes
  std::vector<double> inverse_depths;   // of landmarks at their anchors
  CalibrationVector theta;
  double pixel_scale = 1.0;
  double depth_scale = 1.0;
};

// What the factors of a calibration share. By default the numbers of their
// CalibrationBlock are theta.
inline std::shared_ptr<const CalibrationModel> ModelOf(
    const CalibrationViews& views, const CalibrationOrigin& origin = {}) {
  return std::make_shared<CalibrationModel>(
      CalibrationModel{views.camera, origin});
}

// The poses of a state's keyframes, as factors read them.
inline std::vector<PoseOf<double>> PosesOf(const CalibrationState& state) {
  std::vector<PoseOf<double>> poses;
  for (const Rigid3d& pose : state.world_from_cam) {
    poses.push_back(PoseFrom(pose));
  }
  return poses;
}

// When a row (px) of a keyframe is exposed, and the keyframe's velocity.
inline RowMotion MotionAt(const CalibrationViews& views, int keyframe,
                          double row) {
  return {views.twists[keyframe],
          Shutter{0.0, 1.0}.RowTime(row, views.camera.height)};
}

// The measurements of a landmark at its anchor; the state scales sigmas.
inline LandmarkData DataOf(const CalibrationViews& views,
                           const Landmark& landmark,
                           const CalibrationState& state) {
  LandmarkData data;
  data.anchor_u = landmark.u;
  data.anchor_v = landmark.v;
  data.anchor_motion = MotionAt(views, landmark.anchor, landmark.v);
  data.motion = data.anchor_motion;
  data.depth = landmark.depth;
  data.depth.inverse_sigma /= state.depth_scale;
  return data;
}

// The same in one view.
inline LandmarkData DataOf(const CalibrationViews& views,
                           const Landmark& landmark, const LandmarkView& view,
                           const CalibrationState& state) {
  LandmarkData data = DataOf(views, landmark, state);
  data.u = view.u;
  data.v = view.v;
  data.motion = MotionAt(views, view.keyframe, view.v);
  data.inverse_sigma_px = 1.0 / (view.sigma_px * state.pixel_scale);
  data.depth = view.depth;
  data.depth.inverse_sigma /= state.depth_scale;
  return data;
}

}  // namespace rgbd_pose
