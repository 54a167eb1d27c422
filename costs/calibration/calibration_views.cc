#include "costs/calibration/calibration_views.h"

namespace rgbd_pose {

std::vector<MotionDerivatives> PosesOf(const CalibrationState& state) {
  std::vector<MotionDerivatives> poses;
  const MotionVector zero = MotionVector::Zero();
  for (const Rigid3d& pose : state.world_from_cam) {
    poses.push_back(
        LinearizationPoint(pose.Inverse()).DerivativesAt(zero.data()));
  }
  return poses;
}

RowMotion MotionAt(const CalibrationViews& views, int keyframe, double row) {
  return {views.twists[keyframe],
          Shutter{0.0, 1.0}.RowTime(row, views.camera.height)};
}

LandmarkData DataOf(const CalibrationViews& views, const Landmark& landmark,
                    const CalibrationState& state) {
  LandmarkData data;
  data.rest = &views.camera;
  data.anchor_u = landmark.u;
  data.anchor_v = landmark.v;
  data.anchor_motion = MotionAt(views, landmark.anchor, landmark.v);
  data.motion = data.anchor_motion;
  data.depth = landmark.depth;
  data.depth.inverse_sigma /= state.depth_scale;
  return data;
}

LandmarkData DataOf(const CalibrationViews& views, const Landmark& landmark,
                    const LandmarkView& view, const CalibrationState& state) {
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
